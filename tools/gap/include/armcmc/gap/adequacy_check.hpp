#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/blocks.hpp"
#include "armcmc/gap/fit.hpp"

namespace armcmc::gap {

/// The part of the residual of a hypothesis that a flexible model predicts.
struct Remainder {
  Vector gain;                  ///< Log score of each block relative to the hypothesis, nats.
  Vector unexplained;           ///< Whitened residual of hypothesis and flexible model together.
  double line_frequency = 0.0;  ///< Hz, of the spectral line among the columns; 0: none.
  [[nodiscard]] double total() const { return gain.sum(); }
};

/// Adequacy test: ridge regression of the residual on piecewise linear functions of every variable, memory, reversals,
/// and a spectral line. What it predicts on blocks left out is structure that the hypothesis lacks.
class AdequacyCheck {
 public:
  /// @param predicted  Prediction of the base model, from which features of the force are computed.
  AdequacyCheck(const Fitter& fitter, const Vector& predicted);

  [[nodiscard]] Remainder Judge(const Fitted& fitted) const;
  /// Gain of the groups of these names and of `extra` columns (not whitened), alone.
  [[nodiscard]] Vector GainOf(const Fitted& fitted, const std::vector<std::string>& groups, const Matrix& extra) const;
  /// Gain of all groups and `extra` columns (whitened) together.
  [[nodiscard]] Vector GainOfAll(const Fitted& fitted, const Matrix& extra) const;
  [[nodiscard]] const std::vector<FeatureGroup>& groups() const { return groups_; }

 private:
  /// Gain of all columns, using the stored products.
  [[nodiscard]] Vector GainOfAll(const Fitted& fitted, const Matrix& extra, Vector* unexplained) const;

  const Fitter* fitter_;
  std::vector<FeatureGroup> groups_;
  Matrix columns_;    ///< All groups, whitened, each column of rms one.
  BlockGrams grams_;  ///< Of columns_; cross and squares are not used.
};

}  // namespace armcmc::gap
