package armcmc.spy.model;

import armcmc.spy.Check;

public class DensityTest {
  public void uniformHasTheMomentsOfTheBook() {
    Density d = new Density(2, 6, new double[] {1, 1, 1, 1}, 4);
    Check.near(4, d.mean(), 1e-12);
    Check.near(4 / Math.sqrt(12), d.sd(), 1e-12);  // (b - a) / sqrt(12)
    Check.near(2.1, d.quantile(0.025), 1e-12);
    Check.near(4, d.quantile(0.5), 1e-12);
    Check.near(0.25, d.peak(), 1e-12);
  }

  public void quantilesSkipEmptyBins() {
    Density d = new Density(0, 4, new double[] {0, 1, 0, 1}, 4);
    Check.near(1, d.quantile(0), 1e-12);
    Check.near(2, d.quantile(0.5), 1e-12);
    Check.near(4, d.quantile(1), 1e-12);
  }

  public void isZeroOutside() {
    Density d = new Density(0, 1, new double[] {1}, 1);
    Check.equal(0.0, d.at(-0.1));
    Check.equal(0.0, d.at(1.1));
    Check.near(1, d.at(0.5), 1e-12);
  }

  public void refusesWhatIsNoDistribution() {
    double[][] bad = {{0, 0}, {Double.NaN, Double.NaN}};
    for (double[] density : bad) {
      try {
        new Density(0, 1, density, 2);
        throw new AssertionError("accepted");
      } catch (IllegalArgumentException expected) {
        continue;
      }
    }
    try {
      new Density(1, 1, new double[] {1}, 1);
      throw new AssertionError("accepted");
    } catch (IllegalArgumentException expected) {
      Check.that(expected.getMessage() != null, "says why");
    }
  }
}
