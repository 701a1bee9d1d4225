package armcmc.spy.model;

import armcmc.data_pack_t;
import armcmc.plant_truth_t;
import java.util.Arrays;

/** The true parameters, where a simulated plant tells them. */
public final class Truth {
  static final int MODES = 4;
  private final double[][] theta = new double[MODES][];
  private boolean sharedByModes;

  public void accept(plant_truth_t truth) {
    sharedByModes = truth.plant_kind == data_pack_t.PLANT_HUNT_CROSSLEY;
    int mode = sharedByModes ? 0 : truth.true_mode;
    if (mode < 0 || mode >= MODES) return;
    int n = Math.max(0, Math.min(truth.n_params, plant_truth_t.MAX_PARAMS));
    theta[mode] = Arrays.copyOf(truth.theta_true, n);
  }

  /** NaN where it is not known. */
  public double of(int mode, int parameter) {
    int m = sharedByModes ? 0 : mode;
    if (m < 0 || m >= MODES || theta[m] == null || parameter >= theta[m].length) return Double.NaN;
    return theta[m][parameter];
  }
}
