package armcmc.spy.model;

import armcmc.spy.Check;

public class SeriesTest {
  public void oneKilohertzBecomesTheResolution() {
    Series series = new Series(10, 0.05, Series.Keep.LAST);
    for (int i = 0; i < 30_000; ++i) series.add(0.001 * i, i);
    Check.that(series.size() <= 202, series.size() + " samples for 10 s at 20 Hz");
    Check.that(series.size() >= 195, series.size() + " samples for 10 s at 20 Hz");
    Check.equal(29_999.0, series.last());
    Check.that(series.time(0) > 19, "the oldest is gone");
  }

  public void theLargestSurvivesSoThatASingleBadStepShows() {
    Series series = new Series(10, 0.05, Series.Keep.LARGEST);
    for (int i = 0; i < 100; ++i) series.add(0.001 * i, i == 37 ? 99 : 1);
    Check.equal(99.0, series.quantile(1, 0));
  }

  public void aNumberReplacesAGapInTheSameInterval() {
    Series series = new Series(10, 0.05, Series.Keep.LARGEST);
    series.add(0, Double.NaN);
    series.add(0.01, 2);
    Check.equal(2.0, series.last());
  }

  public void quantilesLeaveOutGapsAndWhatIsOld() {
    Series series = new Series(100, 0.5, Series.Keep.LAST);
    double[] values = {1000, Double.NaN, 1, 2, 3};
    for (int i = 0; i < values.length; ++i) series.add(i, values[i]);
    Check.equal(2.0, series.quantile(0.5, 1));
    Check.that(Double.isNaN(series.quantile(0.5, 50)), "nothing is there");
  }

  public void lateMessagesStandWhereTheyWereSent() {
    SenderClock clock = new SenderClock();
    Check.near(10, clock.time(1000, 10), 1e-9);
    Check.near(10.1, clock.time(1000.1, 10.9), 1e-9);  // late
    Check.near(10.9, clock.time(1001, 10.9), 1e-9);    // faster than the first: no message comes before it is sent
    Check.near(20, clock.time(5, 20), 1e-9);           // another clock
  }
}
