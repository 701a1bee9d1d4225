#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/curve.hpp"

namespace armcmc::gap {

/// One parameter over a recording: refitted to each of several segments.
struct Constancy {
  bool fitted = false;  ///< The model has such a parameter.
  Curve course;       ///< Against the middle of the segment, s, with 95 % bands. Empty: not determined in any segment.
  double mean = 0.0;  ///< Mean of the segments, weighted by their information.
  double moves_by = 0.0;  ///< Standard deviation between segments beyond their uncertainty.
  double p_value = 1.0;   ///< P-value under the hypothesis of a constant parameter.
  bool constant = true;   ///< The p-value is at least 0.01.

  [[nodiscard]] bool known() const { return !course.x.empty(); }
};

struct ParameterDrift {
  std::string name, unit;
  Constancy before, after;
};

/// Quality of predictions made one pack ahead.
struct OneStepScore {
  long long samples = 0;
  double rmse = 0.0;
  double coverage95 = 0.0;  ///< Share of samples inside their 95 % interval.
  double half_width = 0.0;  ///< Mean half width of that interval.
};

/// The estimator run over a recording, pack by pack as live, with the base model and with the named effects.
struct RunAlong {
  bool done = false;
  std::string why_not;  ///< Reason if it was not done.
  bool has_after = false;
  double pack_s = 0.0;                     ///< Duration of a pack, and the horizon of the prediction.
  OneStepScore before, after;              ///< All samples that both predict.
  OneStepScore before_apart, after_apart;  ///< The held-out ones among them.
  Curve error_before, error_after;         ///< Measured minus predicted, the interval about zero, against s.
};

}  // namespace armcmc::gap
