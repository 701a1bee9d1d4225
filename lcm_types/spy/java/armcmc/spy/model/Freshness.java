package armcmc.spy.model;

/** How long ago the last message came, and how often they come. */
public final class Freshness {
  private static final double TIMEOUT = 2.0;
  private double first = Double.NaN;
  private double last = Double.NaN;
  private double interval = Double.NaN;

  /** @param time s */
  public void seen(double time) {
    if (Double.isNaN(first)) first = time;
    if (!Double.isNaN(last)) {
      double gap = time - last;
      interval = Double.isNaN(interval) || gap > TIMEOUT ? gap : interval + 0.05 * (gap - interval);
    }
    last = time;
  }

  public boolean any() { return !Double.isNaN(last); }

  /** Hz; NaN before two messages. */
  public double rate() { return 1 / interval; }

  /** s since the last message. */
  public double age(double now) { return now - last; }

  public boolean stale(double now) { return any() && age(now) > TIMEOUT; }
}
