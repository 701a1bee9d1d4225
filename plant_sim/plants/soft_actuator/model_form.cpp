#include "soft_actuator/effects.hpp"

namespace armcmc::plant_sim {

const ModelForm& ActuatorModelForm() {
  // One prior serves both valves, which says nothing on either.
  static const ModelForm form{{"soft_actuator", "soft_actuator_excited"},
                              {"parameters", "constants", "regress_rate", "pressure_rate"},
                              {{"pressure_bias", "constant", {"bias"}, {}, ModelEffect::Same},
                               {"valve_lag", "spool", {"tau"}, {}, ModelEffect::Same},
                               {"valve_dead_band", "rescaled", {"width"}, {}, ModelEffect::Same},
                               {"supply_droop", "opening", {"droop"}, {}, ModelEffect::Same},
                               {"leak", "linear", {"rate"}, {}, ModelEffect::Same}},
                              true};
  return form;
}

}  // namespace armcmc::plant_sim
