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
/// A trajectory continues from where the last one ended, and where it ended is an estimate: from the start of that
/// pack, corrected by that pack, and from parameters that are uncertain themselves. A start that is
/// off by one standard deviation of the noise is off by as much in every sample of a pack, which a hundred samples take
/// for the parameters. So the start is marginalised, linearised about the mean of the posterior (the step of an
/// extended Kalman filter over a whole pack, x a state, theta a parameter, P in units of the noise's variance s^2):
///
///   A = (P^-1 + S' S)^-1,  x += A S' e,  P_end = f F A F' + ..,  G_end = F (G - A S' (S G + S_theta)) + F_theta
///
/// S = d law / d x_start and F = d x_end / d x_start by differences, S_theta and F_theta those by the parameters; G =
/// d x / d theta, as states and parameters that are learnt from the same packs are not independent. f > 1 so that a
/// model that is a little off does not become overconfident, and more where a pack leaves more than noise, or where
/// the parameters bend what is linear here by as much as they are uncertain.
class StateFilter {
 public:
  static constexpr double kForget = 1.25;  ///< f.

  /// @param plant  Outlives the filter; null: has no states.
  explicit StateFilter(const PlantStates* plant) noexcept : plant_(plant) {}
  [[nodiscard]] bool empty() const noexcept { return plant_ == nullptr || plant_->size() == 0; }

  /// Before a pack: starts are what the plant file says.
  void ForgetOpenStarts() noexcept ARMCMC_NONBLOCKING { opened_.fill(0.0); }

  /// Before the first draw of a pack: sets data->start_fit.
  /// @param mean       Of the posterior before the pack.
  /// @param noise_std  Of what is explained.
  /// @rt No heap, no lock, no throw. A tile of candidates.
  void Predict(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean, double noise_std,
               ModeData* data) noexcept ARMCMC_NONBLOCKING;

  /// Of a pack that continues no other: treats the starts that the plant file gives as unknown, from the next Predict()
  /// on. A recording often begins in motion.
  /// @param mean  About which, as of Predict(), which was called.
  /// @return squares of the errors that are left with the starts of the file; negative: there is none to open.
  /// @rt As Predict().
  [[nodiscard]] double OpenStart(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean,
                                 double noise_std, const ModeData& data) noexcept ARMCMC_NONBLOCKING;
  /// Whether the data contradict the starts of the file, about the mean of a Predict() after OpenStart(); if not, they
  /// hold again from the next Predict() on.
  /// @param fixed_squares  What OpenStart() returned.
  /// @rt As Predict().
  [[nodiscard]] bool StartIsContradicted(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean,
                                         double noise_std, const ModeData& data,
                                         double fixed_squares) noexcept ARMCMC_NONBLOCKING;

  /// After the draws.
  /// @param mean, sd  Of the posterior after the pack.
  /// @param[out] end  State at the last sample.
  /// @rt As Predict().
  void Update(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean,
              const std::array<double, kMaxParams>& sd, double noise_std, const ModeData& data,
              std::array<double, kMaxStates>* end) noexcept ARMCMC_NONBLOCKING;

 private:
  /// Responses to a change of the start: `answer_[s]` of the law, `end_` of the states.
  void Linearise(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean,
                 const std::array<double, kMaxParams>& sd, double noise_std,
                 const ModeData& data) noexcept ARMCMC_NONBLOCKING;

  /// Squares of the errors of `law_` that remain where all starts with a step are free. Sets `sensitivity_`.
  double SquaresLeft(const ModeData& data) noexcept ARMCMC_NONBLOCKING;

  const PlantStates* plant_;
  ParamMatrix start_;  ///< P at the start of the pack.
  ParamMatrix end_covariance_;
  ParamMatrix factor_;  ///< L of P = L L'.
  ParamMatrix slope_;   ///< G at the end of the last pack.
  std::array<double, kMaxParams> about_{}, reach_{};
  std::array<double, kMaxStates> opened_{};  ///< Prior variance of a start that is free; 0: it is fixed.
  std::array<double, kMaxStates> step_{}, trial_{}, sensitivity_{};
  int num_opened_ = 0;
  ThetaTile theta_;
  StateTile offset_, end_;
  PredictionTile law_;
  StartFit fit_;
};

}  // namespace armcmc
