package armcmc.spy.model;

import armcmc.change_t;
import armcmc.estimate_t;
import armcmc.estimator_status_t;

/** What the status panel shows. */
public final class StatusModel implements MessageSink {
  public static final double WINDOW = 60;  // s
  private static final double RESOLUTION = 0.05;

  public final Series collect = largest();
  public final Series adjust = largest();
  public final Series execute = largest();
  public final Series endToEnd = largest();
  public final Series zeta = new Series(WINDOW, RESOLUTION, Series.Keep.LAST);
  public final Series threshold = new Series(WINDOW, RESOLUTION, Series.Keep.LAST);
  public final Series lambda = new Series(WINDOW, RESOLUTION, Series.Keep.LAST);
  public final Series acceptance = new Series(WINDOW, RESOLUTION, Series.Keep.LAST);
  public final Series persisted = new Series(WINDOW, RESOLUTION, Series.Keep.LAST);
  public final Series drifted = new Series(WINDOW, RESOLUTION, Series.Keep.LAST);
  public final Series changed = largest();
  public final Series ownMisses = largest();
  public final Series machineMisses = largest();
  public final Series lateMisses = largest();
  private final Freshness freshness = new Freshness();
  private estimator_status_t status;
  private estimate_t estimate;
  private change_t change;
  private double recentFaultTime = Double.NEGATIVE_INFINITY;
  private int recentFaults;

  @Override public void accept(estimator_status_t message, double now) {
    freshness.seen(now);
    long own = status == null ? 0 : message.missed_own - status.missed_own;
    long machine = status == null ? 0 : message.missed_machine - status.missed_machine;
    long late = status == null ? 0 : message.missed_late_data - status.missed_late_data;
    // A status without a step (no data came) holds no times; zeros would draw a drop that never happened.
    boolean step = message.end_to_end_ns > 0;
    collect.add(now, step ? 1e-6 * message.collect_ns : Double.NaN);
    adjust.add(now, step ? 1e-6 * message.adjust_ns : Double.NaN);
    execute.add(now, step ? 1e-6 * message.execute_ns : Double.NaN);
    endToEnd.add(now, step ? 1e-6 * message.end_to_end_ns : Double.NaN);
    ownMisses.add(now, own);
    machineMisses.add(now, machine);
    lateMisses.add(now, late);
    if (message.fault_flags != 0) {
      // Kept for a moment: a fault of one period is gone before an eye has read it.
      recentFaults = now - recentFaultTime < 3 ? recentFaults | message.fault_flags : message.fault_flags;
      recentFaultTime = now;
    }
    status = message;
  }

  @Override public void accept(estimate_t message, double now) {
    estimate = message;
    boolean updated = message.decision != estimate_t.DECISION_HOLD;
    zeta.add(now, updated ? message.zeta : Double.NaN);
    threshold.add(now, updated && message.zeta_threshold > 0 ? message.zeta_threshold : Double.NaN);
    lambda.add(now, updated ? message.lambda : Double.NaN);
    acceptance.add(now, updated ? message.acceptance : Double.NaN);
  }

  @Override public void accept(change_t message, double now) {
    change = message;
    int mode = changeMode();
    boolean known = message.known[mode] != 0;
    persisted.add(now, known ? message.p_persisted[mode] : Double.NaN);
    drifted.add(now, known ? message.p_drifted[mode] : Double.NaN);
    changed.add(now, known ? message.p_changed[mode] : Double.NaN);
  }

  /** The newest status, or null. */
  public estimator_status_t status() { return status; }

  /** The newest estimate, or null. */
  public estimate_t estimate() { return estimate; }

  /** Probabilities of change, or null. */
  public change_t change() { return change; }

  /** The mode of it whose parameters are reported. */
  public int changeMode() { return change == null ? 0 : Math.max(0, Math.min(change.mode, change_t.MAX_MODES - 1)); }

  /** Faults of the last three seconds. */
  public int recentFaults(double now) { return now - recentFaultTime < 3 ? recentFaults : 0; }

  public Freshness freshness() { return freshness; }

  private static Series largest() { return new Series(WINDOW, RESOLUTION, Series.Keep.LARGEST); }
}
