package armcmc.spy.model;

import armcmc.estimate_t;
import armcmc.plant_truth_t;
import armcmc.posterior_t;

/** What the posterior panel shows. */
public final class PosteriorModel implements MessageSink {
  public static final double WINDOW = 20;  // s

  private final DensityHistory[][] histories = new DensityHistory[Truth.MODES][posterior_t.MAX_PARAMS];
  private final Parameter[] parameters = new Parameter[posterior_t.MAX_PARAMS];
  private final Freshness freshness = new Freshness();
  private final Truth truth = new Truth();
  private int count;
  private int plant;
  private int mode;
  private long seq;
  private boolean known;

  public PosteriorModel() {
    for (int i = 0; i < parameters.length; ++i) parameters[i] = Parameter.unnamed(i);
    for (DensityHistory[] of : histories) {
      for (int i = 0; i < of.length; ++i) of[i] = new DensityHistory(WINDOW, 0.05);
    }
  }

  @Override public void accept(posterior_t message, double now) {
    freshness.seen(now);
    int n = Math.max(0, Math.min(message.n_params, posterior_t.MAX_PARAMS));
    count = n;
    plant = message.plant_kind;
    // Every mode has a history of its own: its parameters are others, and would be read as a jump.
    mode = Math.max(0, Math.min(message.mode, Truth.MODES - 1));
    seq = message.seq;
    known = message.known != 0;
    int bins = Math.min(message.n_bins, posterior_t.MAX_BINS);
    for (int i = 0; known && i < n; ++i) {
      try {
        histories[mode][i].add(now, new Density(message.lo[i], message.hi[i], message.density[i], bins));
      } catch (IllegalArgumentException empty) {
        known = false;  // a posterior without probability says nothing
      }
    }
  }

  @Override public void accept(estimate_t message, double now) {
    for (int i = 0; i < Math.min(message.n_params, parameters.length); ++i) {
      parameters[i] = new Parameter(Text.of(message.param_name[i]), Text.of(message.param_unit[i]));
    }
  }

  @Override public void accept(plant_truth_t message, double now) { truth.accept(message); }

  public int count() { return count; }

  public Parameter parameter(int i) { return parameters[i]; }

  public DensityHistory history(int i) { return histories[mode][i]; }

  /** NaN where it is not known. */
  public double truth(int i) { return truth.of(mode, i); }

  public boolean known() { return known; }

  public long seq() { return seq; }

  public String modeName() { return PlantNames.mode(plant, mode); }

  public Freshness freshness() { return freshness; }
}
