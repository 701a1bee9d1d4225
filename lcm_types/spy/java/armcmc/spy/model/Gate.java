package armcmc.spy.model;

/** Lets through at most one message in a time, so that a bus at 1 kHz costs no more than one at 25 Hz. */
public final class Gate {
  private final double interval;
  private double next = Double.NEGATIVE_INFINITY;

  /** @param interval s */
  public Gate(double interval) { this.interval = interval; }

  public boolean pass(double time) {
    if (time < next) return false;
    next = time + interval;
    return true;
  }
}
