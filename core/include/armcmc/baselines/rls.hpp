#pragma once

#include "armcmc/baselines/pack_filter.hpp"
#include "armcmc/baselines/regression_form.hpp"
#include "armcmc/linear_algebra.hpp"
#include "armcmc/marginal_table.hpp"

namespace armcmc {

/// Recursive least squares with exponential forgetting mu per sample, information weights and saturation:
///
///   P <- P / mu,   k = P phi / (r + phi' P phi),   z <- z + k (y - phi' z),   P <- P - k phi' P
///
/// A law that is linear in its parameters is used as it is. The inputs are scaled by the prior's standard
/// deviations, which does for each of them what the paper's common factor of 1e7 does for both; r = s^2. Where the
/// noise is that of a rate (settings.regress_rate) the law is still that of the flow, since that of the rate is not
/// linear, and r = s^2 E[gain^2], gain = flow / rate by a first pass over the pack. Any other law of a compiled plant
/// comes with a RegressionForm.
///
/// The law of a described plant is linearised about the estimate, by differences over a standard deviation to either
/// side, which are exact where it is linear in its parameters; three times per pack, each time about the previous
/// result:
///
///   phi_d = (F(z + sd_d) - F(z - sd_d)) / (2 sd_d),   y = target - F(z) + phi' z
///
/// States start where the file or the previous pack says, and errors are those that an uncertain start cannot explain,
/// as for the ARMCMC estimator.
///
/// Saturation: after every sample the parameters are held inside the bounds. Noise is taken as Gaussian, whatever its
/// law. The covariance never grows beyond the prior's. Draws: Gaussian with the final mean and covariance.
class RlsFilter final : public PackFilter {
 public:
  static constexpr int kDraws = 2048;

  explicit RlsFilter(const FilterParts& parts);
  Status Run(const ModeData& data, std::uint64_t pack, std::uint64_t mode, Nanos deadline_ns, ClockRef clock, int limit,
             ModeDraws* out) noexcept ARMCMC_NONBLOCKING override;
  void Resume() noexcept ARMCMC_NONBLOCKING override;
  void Reset() noexcept ARMCMC_NONBLOCKING override;

 private:
  void Update(const ParamVector& phi, double y, double r) noexcept ARMCMC_NONBLOCKING;
  /// Updates by all samples. Of a pressure rate: weighted by the gains of a state (gain_z, gain_p).
  void UpdateByAll(const ModeData& data, const ParamVector& gain_z,
                   const ParamMatrix& gain_p) noexcept ARMCMC_NONBLOCKING;
  /// Expected square of flow / rate at a sample: it turns a variance of the rate into one of the flow.
  [[nodiscard]] double SquareGain(const ModeData& data, std::size_t sample, const ParamVector& z,
                                  const ParamMatrix& p) const noexcept ARMCMC_NONBLOCKING;
  /// The same by the law as it is about `z`, with standard deviations from `p`.
  void UpdateByAllLinearised(const ModeData& data, const ParamVector& z,
                             const ParamMatrix& p) noexcept ARMCMC_NONBLOCKING;
  /// Predictions at z, lane 0, and to either side of it in direction d, lanes 1 + 2 d and 2 + 2 d.
  /// @return the distance of these two, 0 where there is none.
  ParamVector Linearise(const ModeData& data, const ParamVector& z, const ParamMatrix& p) noexcept ARMCMC_NONBLOCKING;
  /// Runs one pass over the pack from the state before it.
  void Again(const ModeData& data, const ParamVector& before_z,
             const ParamMatrix& before_p) noexcept ARMCMC_NONBLOCKING;
  void Saturate() noexcept ARMCMC_NONBLOCKING;
  /// Standardised coordinates of the sampled parameters for a state z.
  void ToDraw(const ParamVector& z, double* u) const noexcept ARMCMC_NONBLOCKING;

  FilterParts parts_;
  const RegressionForm* form_ = nullptr;  ///< Null: linear as it is, or linearised.
  bool several_modes_ = false;
  std::unique_ptr<PredictionTile> prediction_;  ///< Of a described plant, else null.
  ThetaTile theta_{};
  MarginalTable normal_table_;
  int dim_;
  ParamVector prior_mean_, z_;
  ParamMatrix prior_, p_;
  bool known_ = false;
};

}  // namespace armcmc
