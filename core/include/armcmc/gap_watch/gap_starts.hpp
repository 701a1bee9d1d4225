#pragma once

#include <array>

#include "armcmc/data_pack.hpp"
#include "armcmc/last_pack.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/plant/states.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
}

/// Orthonormal directions u_j in the samples of one pack, and the projection Q = I - sum_j u_j u_j' onto their
/// orthogonal complement.
class GapDirections {
 public:
  using Samples = std::array<double, kMaxPackSamples>;

  void Clear(int num_samples) noexcept ARMCMC_NONBLOCKING;
  /// Adds the part of `direction` that is orthogonal to the others; nothing if that is rounding error, or without room.
  void Add(const Samples& direction) noexcept ARMCMC_NONBLOCKING;
  /// values <- Q values; zero where nothing but rounding error is left. @rt O(samples x directions).
  void Remove(Samples* values) const noexcept ARMCMC_NONBLOCKING;
  /// sum_j (u_j' values)^2
  [[nodiscard]] double SquaresAlong(const Samples& values) const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] int count() const noexcept ARMCMC_NONBLOCKING { return count_; }

 private:
  int num_samples_ = 0;
  int count_ = 0;
  std::array<Samples, kMaxStates> direction_{};
};

/// Where the states of a described plant start in a pack, as unknowns of that pack alone.
///
/// They are fitted to the pack by a damped Gauss-Newton iteration at given parameters,
///
///   x <- x + (S' S + l diag(S' S))^-1 S' (y - law(x)),   S = d law / d x by central differences,
///
/// with the largest l that fits as well as any up to chance, so that a start that the pack does not determine stays
/// where the last pack ended. The directions S are then what a start can explain: projected out of errors, slopes and
/// templates (GapDirections), they count neither as gap nor as noise.
///
/// States that represent functions with memory are treated alike: low passes, integrals and delayed states start where
/// the pack says, not where their past would have left them.
class GapStarts {
 public:
  /// @param plant  Outlives this.
  GapStarts(const PlantStates& plant, const simd::Kernels& kernels) noexcept : plant_(plant), kernels_(kernels) {}

  /// @param pack       Whose law is in `data`, in order: the guess for the next one is where this one ends.
  /// @param theta      Sampled parameters.
  /// @param noise_std  Unit of what is explained.
  /// @param run        Of data->states; on return it begins with the starts, for all parameters.
  /// @return false when no trajectory is finite, or when the fit has not converged: what a start explains is then not
  /// linear. @rt No heap, no lock, no throw. A few tiles of candidates.
  [[nodiscard]] bool Fit(const DataPack& pack, const std::array<double, kMaxParams>& theta, double noise_std,
                         ModeData* data, StateRun* run) noexcept ARMCMC_NONBLOCKING;
  void Reset() noexcept ARMCMC_NONBLOCKING;

  /// What the starts of the last Fit() explain, of all samples of the pack.
  [[nodiscard]] const GapDirections& directions() const noexcept { return directions_; }

 private:
  static constexpr int kIterations = 2;
  using States = std::array<double, kMaxStates>;

  [[nodiscard]] std::size_t NumStates() const noexcept { return static_cast<std::size_t>(plant_.size()); }
  /// Sum of squared errors of a lane, in units of the noise.
  [[nodiscard]] double SquaresOf(const ModeData& data, std::size_t lane) const noexcept ARMCMC_NONBLOCKING;
  void RunFrom(const ModeData& data, StateRun* run) noexcept ARMCMC_NONBLOCKING;
  /// The better of the file's start and the end of the last pack.
  [[nodiscard]] bool Guess(bool continues, ModeData* data, StateRun* run) noexcept ARMCMC_NONBLOCKING;
  /// The law about `start_`, and steps that suit the noise.
  void Differentiate(const ModeData& data, StateRun* run) noexcept ARMCMC_NONBLOCKING;
  void Improve(const ModeData& data, StateRun* run) noexcept ARMCMC_NONBLOCKING;
  /// d law / d start of state s at row k, of the last Differentiate(); in units of the noise.
  [[nodiscard]] double Slope(std::size_t k, std::size_t s) const noexcept ARMCMC_NONBLOCKING {
    return (law_.value[k][1 + 2 * s] - law_.value[k][2 + 2 * s]) / (2.0 * used_step_[s] * noise_std_);
  }

  const PlantStates& plant_;
  const simd::Kernels& kernels_;
  double noise_std_ = 1.0;
  States start_{}, end_of_last_{};
  States size_{};                ///< Recent size of each state.
  States step_{}, used_step_{};  ///< Of the difference quotients.
  LastPack last_;
  GapDirections directions_;
  ThetaTile theta_;
  StateTile offset_{}, end_;
  PredictionTile law_;
};

}  // namespace armcmc
