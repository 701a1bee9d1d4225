#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/curve.hpp"

namespace armcmc::gap {

/// How one parameter behaves over a recording: fitted anew to each of several stretches of it.
struct Steadiness {
  bool fitted = false;    ///< The model has such a parameter.
  Curve course;           ///< Against the middle of the stretch, s, with 95 % bands. Empty: no stretch tells it.
  double mean = 0.0;      ///< Of the stretches, weighted by what they tell.
  double moves_by = 0.0;  ///< Standard deviation from stretch to stretch beyond what the bands explain.
  double p_value = 1.0;   ///< Of so much movement where there is none.
  bool constant = true;   ///< It is at least 1 %.

  [[nodiscard]] bool known() const { return !course.x.empty(); }
};

struct ParameterDrift {
  std::string name, unit;
  Steadiness before, after;
};

/// Predictions that were made before the data were seen, against the data.
struct OneStepScore {
  long long samples = 0;
  double rmse = 0.0;
  double coverage95 = 0.0;  ///< Share of samples inside the 95 % interval that was given for them.
  double half_width = 0.0;  ///< Mean of that interval.
};

/// What happens while a recording goes by, with the model as it is, and with what was named: how the estimator
/// predicts, pack by pack, as live.
struct RunAlong {
  bool done = false;
  std::string why_not;  ///< Of what is missing, for people.
  bool has_after = false;
  double pack_s = 0.0;                     ///< Length of a pack: predictions reach that far ahead.
  OneStepScore before, after;              ///< All samples that both predict.
  OneStepScore before_apart, after_apart;  ///< Those of them that were kept apart.
  Curve error_before, error_after;         ///< Measured minus predicted, the interval about zero, against s.
};

}  // namespace armcmc::gap
