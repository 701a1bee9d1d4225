package armcmc.spy.model;

import armcmc.change_t;
import armcmc.data_pack_t;
import armcmc.estimate_t;
import armcmc.estimator_status_t;
import armcmc.plant_truth_t;
import armcmc.posterior_t;

/** Takes what comes from the bus. Times are seconds of a clock that never jumps. */
public interface MessageSink {
  default void accept(data_pack_t message, double now) {}

  default void accept(plant_truth_t message, double now) {}

  default void accept(estimate_t message, double now) {}

  default void accept(posterior_t message, double now) {}

  default void accept(change_t message, double now) {}

  default void accept(estimator_status_t message, double now) {}
}
