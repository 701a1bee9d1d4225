package armcmc.spy.model;

import armcmc.data_pack_t;
import armcmc.estimate_t;
import armcmc.plant_truth_t;

/** What the estimate panel shows. */
public final class EstimateModel implements MessageSink {
  public static final double WINDOW = 30;         // s, of the parameters
  public static final double OUTPUT_WINDOW = 10;  // s, of the output

  private final Band[][] bands = new Band[estimate_t.MAX_MODES][estimate_t.MAX_PARAMS];
  private final Parameter[] parameters = new Parameter[estimate_t.MAX_PARAMS];
  private final Freshness freshness = new Freshness();
  private final Truth truth = new Truth();
  private final Band output = new Band(OUTPUT_WINDOW, 0.02);
  private final Series measured = new Series(OUTPUT_WINDOW, 0.01, Series.Keep.LAST);
  private estimate_t last;
  private int mode;  // whose parameters are reported

  public EstimateModel() {
    for (int i = 0; i < parameters.length; ++i) parameters[i] = Parameter.unnamed(i);
    for (Band[] of : bands) {
      for (int i = 0; i < of.length; ++i) of[i] = new Band(WINDOW, 0.05);
    }
  }

  @Override public void accept(estimate_t message, double now) {
    freshness.seen(now);
    last = message;
    // While no identified mode acts, the parameters stay those of the last one.
    if (message.in_contact != 0) mode = Math.max(0, Math.min(message.mode, estimate_t.MAX_MODES - 1));
    for (int i = 0; i < count(); ++i) {
      parameters[i] = new Parameter(Text.of(message.param_name[i]), Text.of(message.param_unit[i]));
      add(bands[mode][i], i, message, now);
    }
    // Before anything is known the prediction is zero, which is no prediction.
    if (message.known == 0) return;
    double time = 1e-9 * message.t_last_ns;
    output.mean.add(time, message.y_pred);
    output.q025.add(time, message.y_lo);
    output.q975.add(time, message.y_hi);
  }

  @Override public void accept(data_pack_t message, double now) {
    int n = Math.max(0, Math.min(message.n_samples, data_pack_t.MAX_SAMPLES));
    double time = 1e-9 * message.t_last_ns;
    for (int i = 0; i < n; ++i) measured.add(time - (n - 1 - i) * message.dt, message.y[i]);
  }

  @Override public void accept(plant_truth_t message, double now) { truth.accept(message); }

  public int count() { return last == null ? 0 : Math.max(0, Math.min(last.n_params, estimate_t.MAX_PARAMS)); }

  public Parameter parameter(int i) { return parameters[i]; }

  public Band band(int i) { return bands[mode][i]; }

  /** NaN where it is not known. */
  public double truth(int i) { return last == null ? Double.NaN : truth.of(mode, i); }

  /** The newest message, or null. */
  public estimate_t last() { return last; }

  /** Predicted output at the last sample of each pack; times are those of the plant's clock, s. */
  public Band output() { return output; }

  /** Measured output, s of the plant's clock. */
  public Series measured() { return measured; }

  /** Whose parameters are shown. */
  public String modeName() { return last == null ? "" : PlantNames.mode(last.plant_kind, mode); }

  public Freshness freshness() { return freshness; }

  private void add(Band band, int i, estimate_t message, double now) {
    boolean known = message.known != 0;
    band.mean.add(now, known ? message.ar_ap[i] : Double.NaN);
    band.q025.add(now, known ? message.q025[i] : Double.NaN);
    band.q25.add(now, known ? message.q25[i] : Double.NaN);
    band.q75.add(now, known ? message.q75[i] : Double.NaN);
    band.q975.add(now, known ? message.q975[i] : Double.NaN);
    band.truth.add(now, truth(i));
  }
}
