#pragma once

#include <array>

#include "armcmc/linear_algebra.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/plant/start_fit.hpp"
#include "armcmc/plant/states.hpp"

namespace armcmc::simd {
struct Kernels;
}

namespace armcmc {

/// Where the states of a described plant are, and how well that is known, from pack to pack.
///
/// A trajectory goes on from where the last one ended, and where it ended is an estimate: from the start of that pack,
/// corrected by what the pack has said on it, and from parameters that are uncertain themselves. A start that is off by
/// one standard deviation of the noise is off by as much in every sample of a pack, which a hundred samples take for
/// the parameters. So the start is marginalised, linearised about the mean of the posterior (the step of an extended
/// Kalman filter over a whole pack, x a state, theta a parameter, P in units of the noise's variance s^2):
///
///   P_start = P + ..,  A = (P^-1 + S' S)^-1,  x += A S' e,  P_end = f (F A F') + sum_d s^-2 (dx_end/dtheta_d sd_d)^2
///
/// S = d law / d x_start and F = d x_end / d x_start by differences, f > 1 so that a model that is a little off does
/// not become sure of itself.
class StateFilter {
 public:
  static constexpr double kForget = 1.25;  ///< f.

  /// @param plant  Outlives the filter; null: has no states.
  explicit StateFilter(const PlantStates* plant) noexcept : plant_(plant) {}
  [[nodiscard]] bool empty() const noexcept { return plant_ == nullptr || plant_->size() == 0; }

  /// Before the first draw of a pack: sets data->start_fit.
  /// @param mean       Of the posterior before the pack.
  /// @param noise_std  Of what is explained.
  /// @rt No heap, no lock, no throw. A tile of candidates.
  void Predict(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean, double noise_std,
               ModeData* data) noexcept ARMCMC_NONBLOCKING;

  /// After the draws.
  /// @param mean, sd  Of the posterior after the pack.
  /// @param[out] end  State at the last sample.
  /// @rt As Predict().
  void Update(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean,
              const std::array<double, kMaxParams>& sd, double noise_std, const ModeData& data,
              std::array<double, kMaxStates>* end) noexcept ARMCMC_NONBLOCKING;

 private:
  /// Answers to a start that is off: `answer_[s]` of the law, `end_` of the states.
  void Linearise(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean,
                 const std::array<double, kMaxParams>& sd, double noise_std,
                 const ModeData& data) noexcept ARMCMC_NONBLOCKING;

  const PlantStates* plant_;
  ParamMatrix start_;  ///< P at the start of the pack.
  ParamMatrix end_covariance_;
  ParamMatrix factor_;  ///< L of P = L L'.
  std::array<double, kMaxStates> step_{};
  ThetaTile theta_;
  StateTile offset_, end_;
  PredictionTile law_;
  StartFit fit_;
};

}  // namespace armcmc
