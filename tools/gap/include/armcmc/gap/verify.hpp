#pragma once

#include <utility>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/result.hpp"

namespace armcmc::gap {

/// Predictions of a fitted hypothesis on held-out data.
struct Trial {
  Vector residual;  ///< [held-out row]
  Vector predicted;
  Vector band_sd;  ///< Of the prediction: noise and parameters.
  Vector whitened;
  Matrix whitened_jacobian;
};

/// The held-out data, used once at the end.
class HeldOut {
 public:
  /// @param recording  Rows [first, end) are held out; earlier rows only initialise the memory of effects.
  /// @throws std::invalid_argument if too few rows are held out.
  HeldOut(const Equation& equation, const Analysis& analysis, const Recording& recording, Eigen::Index first);

  [[nodiscard]] Trial Try(const Fitted& fitted) const;
  [[nodiscard]] Fit Judge(const Trial& trial) const;
  /// Noise floor: standard deviation of the error of `after` without the part that a flexible model predicts.
  [[nodiscard]] double NoiseFloor(const Trial& after) const;
  /// Share of the gap that `after` closes outside the fifth of the blocks with the largest error, with the noise of the
  /// diagnosis.
  [[nodiscard]] double ClosedOutsideWorstBlocks(const Fitted& before, const Fitted& after) const;
  /// Whether the difference between the predictions of `before` and `after` is present in the held-out data as
  /// predicted: the regression of the residual of `before` on it, both whitened, has a slope whose 95 % interval lies
  /// between 2/3 and 3/2. What else these data contain does not matter then.
  [[nodiscard]] bool FoundAsPredicted(const Fitted& before, const Fitted& after, const BlockBootstrap& bootstrap) const;
  /// The same where `before` has an error of the law, which does not extrapolate: its parameters are fitted to the
  /// held-out data as well, with what the diagnosed data say of them as prior, and then the effect must also close at
  /// least the share `least` of the gap.
  [[nodiscard]] bool FoundBesideLawError(const Fitted& before, const Fitted& after, const BlockBootstrap& bootstrap,
                                         double least) const;
  [[nodiscard]] const Signals& signals() const { return tail_; }

 private:
  [[nodiscard]] double MeasureNoiseFloor(const Trial& after) const;

  const Equation* equation_;
  const Analysis* analysis_;
  Signals all_, tail_;
  Eigen::Index first_;
  mutable std::vector<std::pair<Vector, double>>
      floors_;  ///< By prediction: the same models are shown again and again.
};

/// Step five: the gap on held-out data with the base model, with `after`, and with `control` (may be null).
[[nodiscard]] GapSummary ShowGap(const Equation& equation, const HeldOut& data, const BlockBootstrap& bootstrap,
                                 const Fitted& before, const Fitted& after, const Fitted* control);

}  // namespace armcmc::gap
