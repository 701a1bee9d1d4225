package armcmc.spy.draw;

import armcmc.spy.Check;
import java.util.List;

public class AxisTest {
  public void ticksAreRound() {
    Axis axis = Axis.linear(3.983, 4.012);
    List<Double> ticks = axis.ticks(3);
    Check.that(ticks.size() >= 2 && ticks.size() <= 4, ticks + "");
    Check.equal("3.99", axis.text(ticks.get(0), 3));
  }

  public void noScaleHasOneTickAlone() {
    for (double lo = 3.99; lo < 4.01; lo += 0.0013) {
      for (double size = 0.001; size < 1; size *= 1.7) {
        int ticks = Axis.linear(lo, lo + size).ticks(3).size();
        Check.that(ticks >= 2 && ticks <= 7, ticks + " ticks from " + lo + " over " + size);
      }
    }
  }

  public void aLogarithmicAxisHasPowersOfTen() {
    Axis axis = Axis.logarithmic(0.01, 100);
    Check.equal(5, axis.ticks(4).size());
    Check.near(0.5, axis.at(1), 1e-12);
    Check.near(1, axis.value(0.5), 1e-12);
    Check.equal("0.01", axis.text(0.01, 4));
    Check.equal("100", axis.text(100, 4));
  }

  public void neighbouringTicksReadDifferently() {
    for (double size : new double[] {1e-9, 1e-4, 1, 1e3, 1e8}) {
      Axis axis = Axis.linear(5 * size, 5.01 * size);
      List<Double> ticks = axis.ticks(4);
      for (int i = 1; i < ticks.size(); ++i) {
        Check.that(!axis.text(ticks.get(i), 4).equals(axis.text(ticks.get(i - 1), 4)), axis.text(ticks.get(i), 4) + " twice");
      }
    }
  }

  public void aRangeHoldsWhatItWasGiven() {
    Range range = new Range();
    range.include(Double.NaN);
    range.include(2);
    range.include(3);
    Axis axis = range.axis();
    Check.that(axis.lo < 2 && axis.hi > 3 && axis.hi - axis.lo < 2, axis.lo + " .. " + axis.hi);
    Range one = new Range();
    one.include(7);
    Axis constant = one.axis();
    Check.that(constant.lo < 7 && constant.hi > 7, "room around a constant");
    Check.that(new Range().axis().hi > new Range().axis().lo, "room around nothing");
  }
}
