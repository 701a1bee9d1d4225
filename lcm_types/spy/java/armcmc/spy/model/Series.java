package armcmc.spy.model;

import java.util.Arrays;

/**
 * The last seconds of one number. Samples nearer to each other than the resolution become one, so that a rate of
 * 1 kHz costs no more memory and drawing than 20 Hz; what survives is the last or the largest of them.
 */
public final class Series {
  /** What stays of samples that become one. */
  public enum Keep { LAST, LARGEST }

  private final Keep keep;
  private final double resolution;
  private final double[] times;
  private final double[] values;
  private int first;
  private int size;

  /** @param window s, what is kept; @param resolution s, least distance of two samples */
  public Series(double window, double resolution, Keep keep) {
    this.keep = keep;
    this.resolution = resolution;
    int capacity = (int) Math.ceil(window / resolution) + 2;
    times = new double[capacity];
    values = new double[capacity];
  }

  /** @param time s, not before the last; a value that is no number is a gap in the line */
  public void add(double time, double value) {
    if (size > 0 && time - time(size - 1) < resolution) {
      int last = index(size - 1);
      boolean replace = keep == Keep.LAST || !(values[last] >= value);
      if (replace) values[last] = value;
      return;
    }
    if (size == times.length) {
      first = (first + 1) % times.length;
      --size;
    }
    times[index(size)] = time;
    values[index(size)] = value;
    ++size;
  }

  public int size() { return size; }

  /** s; i counts from the oldest. */
  public double time(int i) { return times[index(i)]; }

  public double value(int i) { return values[index(i)]; }

  /** The newest value; NaN before the first. */
  public double last() { return size == 0 ? Double.NaN : value(size - 1); }

  /** Value below which a share of the finite values since a time lies; NaN when there is none. */
  public double quantile(double share, double since) {
    double[] finite = new double[size];
    int n = 0;
    for (int i = 0; i < size; ++i) {
      if (time(i) >= since && Double.isFinite(value(i))) finite[n++] = value(i);
    }
    if (n == 0) return Double.NaN;
    Arrays.sort(finite, 0, n);
    return finite[(int) Math.round(share * (n - 1))];
  }

  private int index(int i) { return (first + i) % times.length; }
}
