package armcmc.spy.model;

/**
 * When a message was sent, on our clock. A screen that stood still for a moment gets its messages all at once; drawn at
 * their arrival they would be a gap and a heap.
 */
public final class SenderClock {
  private static final double JUMP = 2;  // s: more is another clock, not a delay
  private double offset = Double.NaN;

  /** @param sent s, clock of the sender; @param arrival s, our clock; @return s, our clock, not after arrival */
  public double time(double sent, double arrival) {
    double latest = arrival - sent;
    // The fastest message tells how far the clocks are apart.
    if (Double.isNaN(offset) || latest < offset || latest > offset + JUMP) offset = latest;
    return sent + offset;
  }
}
