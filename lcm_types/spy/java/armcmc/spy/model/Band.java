package armcmc.spy.model;

/** One estimate over time: mean with its 50 % and 95 % interval, and the truth. */
public final class Band {
  public final Series mean;
  public final Series q025;
  public final Series q25;
  public final Series q75;
  public final Series q975;
  public final Series truth;

  public Band(double window, double resolution) {
    mean = new Series(window, resolution, Series.Keep.LAST);
    q025 = new Series(window, resolution, Series.Keep.LAST);
    q25 = new Series(window, resolution, Series.Keep.LAST);
    q75 = new Series(window, resolution, Series.Keep.LAST);
    q975 = new Series(window, resolution, Series.Keep.LAST);
    truth = new Series(window, resolution, Series.Keep.LAST);
  }
}
