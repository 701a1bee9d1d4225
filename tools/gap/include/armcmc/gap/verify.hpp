#pragma once

#include <utility>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/result.hpp"

namespace armcmc::gap {

/// Predictions of a fitted hypothesis on data that had no part in the fit.
struct Trial {
  Vector residual;  ///< [held-out row]
  Vector predicted;
  Vector band_sd;  ///< Of the prediction: noise and parameters.
  Vector whitened;
  Matrix whitened_jacobian;
};

/// The sealed part of the data, opened once at the end.
class HeldOut {
 public:
  /// @param recording  Rows [first, end) are held out; those before only start the memory of effects.
  /// @throws std::invalid_argument when too few rows are held out.
  HeldOut(const Equation& equation, const Look& look, const Recording& recording, Eigen::Index first);

  [[nodiscard]] Trial Try(const Fitted& fitted) const;
  [[nodiscard]] Fit Judge(const Trial& trial) const;
  /// Standard deviation of what no model explains: the error of `after` less what a flexible model still predicts of
  /// it.
  [[nodiscard]] double NoiseFloor(const Trial& after) const;
  /// Share of the gap that `after` closes where nothing else happens: the fifth of the blocks that it leaves most error
  /// in is put aside, the noise is that of the diagnosis.
  [[nodiscard]] double ClosedElsewhere(const Fitted& before, const Fitted& after) const;
  [[nodiscard]] const Signals& signals() const { return tail_; }

 private:
  [[nodiscard]] double MeasureNoiseFloor(const Trial& after) const;

  const Equation* equation_;
  const Look* look_;
  Signals all_, tail_;
  Eigen::Index first_;
  mutable std::vector<std::pair<Vector, double>>
      floors_;  ///< By prediction: the same models are shown again and again.
};

/// Step five: the gap on held-out data with the base model and with `after`, and with `control` instead (may be null).
[[nodiscard]] GapSummary ShowGap(const Equation& equation, const HeldOut& data, const BlockBootstrap& bootstrap,
                                 const Fitted& before, const Fitted& after, const Fitted* control);

}  // namespace armcmc::gap
