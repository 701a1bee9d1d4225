#pragma once

#include <vector>

#include "armcmc/baselines/pack_filter.hpp"
#include "armcmc/marginal_table.hpp"

namespace armcmc {

/// Particle filter with the paper's random-walk state: theta_{t+1} = theta_t + jitter, weights from the likelihood.
///
/// Weights are logarithms; resampling is systematic. A well-tuned bootstrap filter: a pack is far more informative
/// than a state, so the likelihood is tempered (Neal 2001): its exponent rises from 0 to 1 in steps that keep half of
/// the particles effective; after each step the particles are resampled and moved by the shrunk kernel of Liu and West
/// (2001), which keeps their mean and covariance. The first particles are drawn from P_0. Its likelihood is that of the
/// configured noise law, computed by the same vector kernels as the ARMCMC estimator's.
class ParticleFilter final : public PackFilter {
 public:
  static constexpr int kMaxStages = 60;    ///< Tempering steps of an update; the last one takes what is left.
  static constexpr double kKernel = 0.25;  ///< h of Liu and West: a = sqrt(1 - h^2).

  explicit ParticleFilter(const FilterParts& parts);
  Status Run(const ModeData& data, std::uint64_t pack, std::uint64_t mode, Nanos deadline_ns, ClockRef clock, int limit,
             ModeDraws* out) noexcept ARMCMC_NONBLOCKING override;
  void Resume() noexcept ARMCMC_NONBLOCKING override;
  void Reset() noexcept ARMCMC_NONBLOCKING override { started_ = false; }

 private:
  class Numbers;
  void Start(Numbers* numbers) noexcept ARMCMC_NONBLOCKING;
  void Walk(double sd, Numbers* numbers) noexcept ARMCMC_NONBLOCKING;
  bool Update(const ModeData& data, Numbers* numbers) noexcept ARMCMC_NONBLOCKING;
  void Score(const ModeData& data) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] double NextStep(double left) const noexcept ARMCMC_NONBLOCKING;
  void Resample(Numbers* numbers) noexcept ARMCMC_NONBLOCKING;
  void Move(Numbers* numbers) noexcept ARMCMC_NONBLOCKING;
  /// Normalises the weights. @return effective number of particles, 0 when no weight is finite.
  double Normalise() noexcept ARMCMC_NONBLOCKING;

  FilterParts parts_;
  MarginalTable normal_table_;
  int count_;
  std::array<std::vector<double>, kMaxParams> u_, spare_;
  std::vector<double> log_weight_, weight_, log_likelihood_;
  ModeData chunk_;
  ThetaTile theta_;
  PredictionTile prediction_;
  bool started_ = false, known_ = false;
  std::uint64_t last_pack_ = 0;
};

}  // namespace armcmc
