#include <cmath>
#include <numbers>

#include "hunt_crossley/effects.hpp"

namespace armcmc::plant_sim {
namespace {

using Values = ModelEffect::Values;

/// The plant gives a drift by what it comes to over the run.
Values OverTheRun(const Values& amplitudes, const Values& shapes, double duration_s) {
  return {amplitudes[0] * duration_s, shapes[0]};
}

Values AmplitudeOnly(const Values& amplitudes, const Values& /*shapes*/, double /*duration_s*/) { return amplitudes; }

/// a sin(w t + phase) = cosine cos(w t) + sine sin(w t).
Values Polar(const Values& amplitudes, const Values& shapes, double /*duration_s*/) {
  return {std::hypot(amplitudes[0], amplitudes[1]), shapes[0], std::atan2(amplitudes[0], amplitudes[1])};
}

}  // namespace

const ModelForm& ContactModelForm() {
  static const ModelForm form{{"hunt_crossley"},
                              {},
                              {{"force_bias", "constant", {"force"}, {}, ModelEffect::Same},
                               {"force_drift", "linear", {"rate"}, {"origin"}, OverTheRun},
                               {"coulomb_friction", "tanh", {"force"}, {"speed"}, ModelEffect::Same},
                               {"presliding_friction", "dahl", {"force"}, {"distance"}, ModelEffect::Same},
                               {"viscous_friction", "linear", {"coefficient"}, {}, ModelEffect::Same},
                               {"inertia", "rigid", {"mass"}, {"smoothing"}, AmplitudeOnly},
                               {"sensor_delay", "dead_time", {"time"}, {}, ModelEffect::Same},
                               {"sensor_lag", "first_order", {"time_constant"}, {}, ModelEffect::Same},
                               {"stress_relaxation", "linear", {"stiffness"}, {"time_constant"}, ModelEffect::Same},
                               {"adhesion", "exponential", {"force"}, {"distance"}, ModelEffect::Same},
                               {"contact_offset", "shift", {"distance"}, {}, ModelEffect::Same},
                               {"sensor_saturation", "clip", {"limit"}, {}, ModelEffect::Same},
                               {"periodic_disturbance", "sine", {"cosine", "sine"}, {"frequency"}, Polar},
                               {"stiffness_drift", "linear", {"rate"}, {"origin"}, OverTheRun}},
                              false};
  return form;
}

}  // namespace armcmc::plant_sim
