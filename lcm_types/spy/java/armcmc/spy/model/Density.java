package armcmc.spy.model;

/** A marginal posterior as a histogram of equal bins. */
public final class Density {
  private final double lo;
  private final double hi;
  private final double[] share;  // of the probability, by bin; sums to 1
  private final double width;

  /** @param density probability density by bin, 1/unit; need not be normalised */
  public Density(double lo, double hi, double[] density, int bins) {
    if (!(hi > lo) || bins < 1) throw new IllegalArgumentException("no interval");
    this.lo = lo;
    this.hi = hi;
    width = (hi - lo) / bins;
    share = new double[bins];
    double sum = 0;
    for (int i = 0; i < bins; ++i) sum += Math.max(0, density[i]);
    if (!(sum > 0)) throw new IllegalArgumentException("no probability");
    for (int i = 0; i < bins; ++i) share[i] = Math.max(0, density[i]) / sum;
  }

  public double lo() { return lo; }

  public double hi() { return hi; }

  public int bins() { return share.length; }

  /** Centre of a bin. */
  public double centre(int i) { return lo + (i + 0.5) * width; }

  /** Probability density of a bin, 1/unit. */
  public double height(int i) { return share[i] / width; }

  /** Probability density, linear between the centres of bins; 0 outside. */
  public double at(double x) {
    if (x < lo || x > hi) return 0;
    double position = (x - lo) / width - 0.5;
    int left = (int) Math.floor(position);
    double weight = position - left;
    return (1 - weight) * heightOrZero(left) + weight * heightOrZero(left + 1);
  }

  public double peak() {
    double peak = 0;
    for (int i = 0; i < share.length; ++i) peak = Math.max(peak, height(i));
    return peak;
  }

  public double mean() {
    double sum = 0;
    for (int i = 0; i < share.length; ++i) sum += share[i] * centre(i);
    return sum;
  }

  /** Standard deviation; bins count as uniform inside. */
  public double sd() {
    double mean = mean();
    double sum = width * width / 12;
    for (int i = 0; i < share.length; ++i) sum += share[i] * Math.pow(centre(i) - mean, 2);
    return Math.sqrt(sum);
  }

  /** @param probability in [0, 1] */
  public double quantile(double probability) {
    double below = 0;
    for (int i = 0; i < share.length; ++i) {
      if (below + share[i] >= probability && share[i] > 0) {
        return lo + (i + (probability - below) / share[i]) * width;
      }
      below += share[i];
    }
    return hi;
  }

  private double heightOrZero(int i) { return i < 0 || i >= share.length ? 0 : height(i); }
}
