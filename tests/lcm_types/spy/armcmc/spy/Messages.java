package armcmc.spy;

import armcmc.change_t;
import armcmc.data_pack_t;
import armcmc.estimate_t;
import armcmc.estimator_status_t;
import armcmc.plant_truth_t;
import armcmc.posterior_t;

/** Messages with something in them. */
public final class Messages {
  private Messages() {}

  public static void set(byte[] field, String text) {
    for (int i = 0; i < text.length(); ++i) field[i] = (byte) text.charAt(i);
  }

  /** Two parameters, K of 3.5 and B of 2, both Gaussian. */
  public static posterior_t posterior(long seq) {
    posterior_t p = new posterior_t();
    p.seq = seq;
    p.plant_kind = data_pack_t.PLANT_HUNT_CROSSLEY;
    p.known = 1;
    p.n_params = 2;
    p.n_bins = 64;
    double[] mean = {3.5, 2};
    double sd = 0.1;
    for (int i = 0; i < 2; ++i) {
      p.lo[i] = mean[i] - 4 * sd;
      p.hi[i] = mean[i] + 4 * sd;
      for (int k = 0; k < 64; ++k) {
        double z = -4 + 8 * (k + 0.5) / 64;
        p.density[i][k] = Math.exp(-z * z / 2) / (sd * Math.sqrt(2 * Math.PI));
      }
    }
    return p;
  }

  public static estimate_t estimate(long seq) {
    estimate_t e = new estimate_t();
    e.seq = seq;
    e.plant_kind = data_pack_t.PLANT_HUNT_CROSSLEY;
    e.known = 1;
    e.in_contact = 1;
    e.decision = estimate_t.DECISION_REINFORCEMENT;
    e.n_params = 2;
    e.n_modes = 1;
    set(e.param_name[0], "K");
    set(e.param_unit[0], "N/m^p");
    set(e.param_name[1], "B");
    set(e.param_unit[1], "N s/m^(p+1)");
    double[] mean = {3.5, 2};
    for (int i = 0; i < 2; ++i) {
      e.ar_ap[i] = e.ar_map[i] = e.q50[i] = mean[i];
      e.sd[i] = 0.1;
      e.q025[i] = mean[i] - 0.196;
      e.q25[i] = mean[i] - 0.067;
      e.q75[i] = mean[i] + 0.067;
      e.q975[i] = mean[i] + 0.196;
    }
    e.t_last_ns = seq * 100_000_000L;
    e.y_pred = 5;
    e.y_lo = 4.8;
    e.y_hi = 5.2;
    e.zeta = 0.2;
    e.zeta_threshold = 1.2;
    e.lambda = 0.9;
    e.acceptance = 0.6;
    e.draws = 14979;
    return e;
  }

  /** Of both parameters of one mode. */
  public static change_t change(long seq) {
    change_t c = new change_t();
    c.seq = seq;
    c.plant_kind = data_pack_t.PLANT_HUNT_CROSSLEY;
    c.n_modes = 1;
    c.n_params = 2;
    set(c.mode_name[0], "contact");
    set(c.param_name[0], "K");
    set(c.param_unit[0], "N/m^p");
    set(c.param_name[1], "B");
    set(c.param_unit[1], "N s/m^(p+1)");
    c.known[0] = c.updated[0] = 1;
    c.p_persisted[0] = 0.25;
    c.p_drifted[0] = 0.625;
    c.p_changed[0] = 0.125;
    c.drift_rate[0][0] = 0.0375;
    c.drift_rate[0][1] = 0.0125;
    return c;
  }

  public static plant_truth_t truth() {
    plant_truth_t t = new plant_truth_t();
    t.plant_kind = data_pack_t.PLANT_HUNT_CROSSLEY;
    t.n_params = 2;
    t.theta_true[0] = 3.55;
    t.theta_true[1] = 2.05;
    return t;
  }

  public static data_pack_t pack(long seq) {
    data_pack_t p = new data_pack_t();
    p.plant_kind = data_pack_t.PLANT_HUNT_CROSSLEY;
    p.t_last_ns = seq * 100_000_000L;
    p.dt = 0.001;
    p.n_samples = 100;
    for (int i = 0; i < 100; ++i) p.y[i] = 5 + Math.sin(0.1 * i);
    return p;
  }

  public static estimator_status_t status(long step) {
    estimator_status_t s = new estimator_status_t();
    s.step = step;
    s.last_seq = step;
    s.period_ns = 100_000_000;
    s.deadline_ns = 100_000_000;
    s.collect_ns = 10_000;
    s.adjust_ns = 40_000_000;
    s.execute_ns = 1_000_000;
    s.end_to_end_ns = 42_000_000;
    s.slack_ns = 58_000_000;
    s.packs_received = step;
    s.gap_watched = 1;
    s.gap_check = -1;
    return s;
  }
}
