#pragma once

#include <array>

#include "armcmc/gap_watch/gap_checks.hpp"
#include "armcmc/gap_watch/gap_evidence.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

inline constexpr int kGapBlockPacks = 120;  ///< Stretches of data in one block, each of a pack or of a few short ones.
inline constexpr int kGapColumns = 8;       ///< Parameters of all modes together.
inline constexpr int kGapSteady = 3;        ///< Each may be constant, change evenly over the block, and step once;
inline constexpr int kGapDirections = 5;    ///< where drift is probable, change as a cubic of time, too.
inline constexpr int kGapNuisance = kGapColumns * kGapDirections;

/// Errors and sensitivities of one pack, in units of the noise.
struct GapRows {
  int num_samples = 0;
  std::array<bool, kMaxPackSamples> used{};      ///< Samples for which the model makes a prediction.
  std::array<double, kMaxPackSamples> error{};   ///< Measured minus predicted; 0 where not used.
  std::array<double, kMaxPackSamples> output{};  ///< Predicted.
  std::array<std::array<double, kMaxPackSamples>, kGapColumns> slope{};  ///< d predicted / d parameter.
  int num_removed = 0;  ///< Directions that are projected out of errors and slopes: those of this pack's own unknowns.
};

/// Change of the parameters of one pack from the point at which it was linearised.
using GapShift = std::array<double, kGapColumns>;

/// Least squares of a block and the scores of its checks.
///
/// In a block the model with any parameters near the reference, even with parameters that drift evenly or step once,
/// predicts  e = J (a + b tau + c step) + noise,  and where the estimator believes that they drift, at a speed that may
/// change,  e = J (a + b tau + c step + d P_2(tau) + e P_3(tau)) + noise.  M is the projection that removes these
/// directions; what the parameters can explain never counts. A region with template phi scores
///
///   S = phi' M e = sum_k (M phi)_k' noise_k = sum_k psi_k       over the packs k of the block,
///   z = S / sqrt(sum_k (psi_k / (1 - h_k))^2),   h_k the leverage of pack k,
///
/// which depends on the noise only. When the noise of a pack is symmetric given the packs before (of any law, any scale
/// from pack to pack, coloured within a pack), z is conditionally sub-Gaussian with variance 1 (Efron 1969, de la Pena
/// 1999); the leverage makes up for psi_k being computed from residuals. The two repeating checks score
/// sum_k d_k' d_{k-1} and sum_k d_k' d_{k-2} the same way, with d_k the errors of a pack without their mean and slope;
/// the two wanders score products of the means of neighbouring packs, and of those two apart. What coloured noise
/// carries from one pack into the next is allowed for up to AR(1) noise with coefficient 0.8 from sample to sample:
/// neighbouring means of n samples then correlate by 0.8 / (0.36 n).
///
/// What else is unknown of a pack alone, as the start of its states, is projected out of e, J and phi beforehand, by
/// Q_k of rank n - r. Q_k noise_k is symmetric where noise_k is, so that nothing else changes; but what is left leans
/// on the ends of the pack, up to 2 r + 1 times as much as its mean (Legendre polynomials do), and neighbours correlate
/// as much more.
class GapBlock {
 public:
  GapBlock(const GapChecks& checks, int num_columns) noexcept : checks_(checks), columns_(num_columns) {}

  /// @param drifts  Whether the estimator believes that the parameters drift.
  void Clear(bool drifts = false) noexcept ARMCMC_NONBLOCKING;
  /// First pass: errors and slopes of pack k alone. @param tau  Place in the block, [-1, 1].
  /// @param changed  Whether the parameters may have stepped before this pack.
  void AddFit(int k, const GapRows& rows, double tau, bool changed) noexcept ARMCMC_NONBLOCKING;
  /// Second pass: with regions, and d_k against those of the packs before when these are neighbours.
  void AddRegions(int k, const GapRows& rows, double tau, bool changed, const RegionTemplates& regions,
                  bool continues) noexcept ARMCMC_NONBLOCKING;
  /// Least squares with a weak prior (precision in units of the noise) on every direction: where to linearise next.
  /// @param damping  Relative to the normal matrix: directions that the block hardly determines move little.
  /// @param[out] shift  Of every pack.
  void Fit(const std::array<double, kGapColumns>& precision, double damping,
           std::array<GapShift, kGapBlockPacks>* shift) noexcept ARMCMC_NONBLOCKING;
  /// After the second pass: the fit that the scores are free of. Where packs have unknowns of their own, and the fit
  /// still moves the prediction by more than a tenth of the noise, the trajectory is not where it is linearised, and
  /// all scores are zero. @rt O(packs).
  void BeginScores() noexcept ARMCMC_NONBLOCKING;
  /// Score of one check; zero where the block has too little information. @pre BeginScores(), and no pack since.
  /// @param tolerance  See GapWatchSettings. @rt O(packs).
  [[nodiscard]] CheckScore Score(int check, double tolerance) noexcept ARMCMC_NONBLOCKING;

  /// After Score() of the check: squared error that a check explains, and all of it beyond the noise; in units of the
  /// noise.
  [[nodiscard]] double explained(int check) const noexcept { return explained_[static_cast<std::size_t>(check)]; }
  [[nodiscard]] double excess() const noexcept { return excess_; }

 private:
  struct RegionSums {
    double error = 0.0, square = 0.0;
    int count = 0;
    std::array<double, kGapColumns> slope{};
  };
  struct PackSums {
    bool used = false;
    std::array<double, kGapDirections> direction{};
    int count = 0;
    int removed = 0;
    double error_square = 0.0;
    std::array<double, kGapColumns> slope_error{};
    std::array<std::array<double, kGapColumns>, kGapColumns> slope_slope{};
    std::array<RegionSums, kMaxRegions> region{};
    std::array<double, 2> echo{};  ///< Products with the last pack and the one before.
  };
  using Vector = std::array<double, kGapNuisance>;

  void AddPrecision(const std::array<double, kGapColumns>& precision, double damping) noexcept ARMCMC_NONBLOCKING;
  void SumNormalMatrix() noexcept ARMCMC_NONBLOCKING;
  /// Cholesky factor; directions that the block cannot tell apart from the ones before are left out.
  void Factor() noexcept ARMCMC_NONBLOCKING;
  void SolveLower(Vector* x) const noexcept ARMCMC_NONBLOCKING;  ///< L x = b
  void SolveUpper(Vector* x) const noexcept ARMCMC_NONBLOCKING;  ///< L' x = b
  [[nodiscard]] GapShift ShiftOf(const PackSums& pack, const Vector& solution) const noexcept ARMCMC_NONBLOCKING;
  void SolveErrors(Vector* solution) const noexcept ARMCMC_NONBLOCKING;
  /// Correlation of neighbouring packs' means that is allowed for.
  [[nodiscard]] double CarryOver() const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] CheckScore ScoreRegion(int region, double tolerance,
                                       double* explained) const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] CheckScore ScoreEcho(int lag, double tolerance, double* explained) const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] CheckScore ScoreWander(int lag, double tolerance, double* explained) const noexcept ARMCMC_NONBLOCKING;
  void Detrend(const GapRows& rows, std::array<double, kMaxPackSamples>* out) const noexcept ARMCMC_NONBLOCKING;

  const GapChecks& checks_;
  int columns_;
  int directions_ = kGapSteady;
  std::array<PackSums, kGapBlockPacks> packs_{};
  std::array<std::array<double, kMaxPackSamples>, 3> detrended_{};  ///< Of this pack and the two before, in turns.
  std::array<int, 3> detrended_count_{};
  std::array<std::array<double, kGapNuisance>, kGapNuisance> matrix_{};  ///< Normal matrix, then its factor.
  std::array<bool, kGapNuisance> kept_{};
  std::array<GapShift, kGapBlockPacks> fit_{};  ///< Of the parameters, where the scores are taken.
  std::array<double, kMaxGapChecks> explained_{};
  double excess_ = 0.0;
  bool converged_ = true;
};

}  // namespace armcmc
