#pragma once

#include <array>
#include <vector>

#include "armcmc/laplace.hpp"
#include "armcmc/linear_algebra.hpp"
#include "armcmc/linear_part.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/parameter_space.hpp"
#include "armcmc/quadratic_form.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
}

/// Predictions that a QuadraticScore is made from: for each linear parameter and without any.
class QuadraticScratch {
 public:
  static constexpr int kNodes = 2 * kTileLanes;  ///< On a line; those of a grid are kTileLanes by kTileLanes.
  using Lines = std::array<std::array<double, kNodes>, QuadraticForm::kMaxFunctions>;

  /// For at most so many linear parameters. Allocates.
  explicit QuadraticScratch(int num_linear) : prediction(static_cast<std::size_t>(num_linear) + 1) {}

  std::vector<PredictionTile> prediction;
  ThetaTile theta;
  alignas(64) Lines sums{};
  Lines series{};
};

/// The Gaussian log-likelihood of a law that has a LinearPart, without reading the samples for every candidate: given
/// the curved parameters, sums over the samples suffice (sufficient statistics), and those are smooth functions of
/// them. They are taken at the Chebyshev points of their bounds and interpolated: on a line where one parameter is
/// curved, on two lines and, for what multiplies functions of either, on a grid where two are.
///
/// Made once a pack. The error of the log-likelihood, in nats, is bounded by the rest of the series and rounding; where
/// that exceeds kTolerance at candidates within a prior standard deviation, ready() is false and the samples have to be
/// scored. So it is where a tile of candidates, half of them where the posterior lies, does not get what the samples
/// give: a law may bend within less than the points are apart.
class QuadraticScore {
 public:
  static constexpr double kTolerance = 1e-6;
  /// Functions on a grid, at most: more would take as long as the samples.
  static constexpr std::size_t kMaxProducts = 4;

  QuadraticScore(const simd::Kernels& kernels, int model, const ParameterSpace& space, const NoiseModel& noise,
                 const LinearPart& part);

  /// The pack can be tried at all: the noise is Gaussian, and something is linear.
  [[nodiscard]] bool applies() const noexcept { return applies_; }

  /// @param fit  Where the posterior lies, about.
  /// @rt No heap, no lock, no throw. 2 (num_linear + 1) + 1 tiles of candidates at most, and their products.
  void Prepare(const ModeData& data, const Gaussian& fit, QuadraticScratch* scratch) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] bool ready() const noexcept { return ready_; }

  /// out[lane] = log-likelihood of u[., first + lane], kTileLanes of them. @pre ready().
  void Score(const double* const* u, int first, double* out) const noexcept ARMCMC_NONBLOCKING;

 private:
  static constexpr int kNodes = QuadraticScratch::kNodes;
  using Lines = QuadraticScratch::Lines;
  /// [k][j] = 2 / n cos(pi k (j + 1/2) / n), half of it for k = 0.
  using CosineTable = std::array<std::array<double, kNodes>, kNodes>;
  using Grid = std::array<std::array<double, kTileLanes>, kTileLanes>;

  /// For that many points. Made once in the process: where several scores take turns, it stays in the cache.
  template <int kPoints>
  [[nodiscard]] static const CosineTable& Cosines();

  void AccumulateSums(const ModeData& data, QuadraticScratch* scratch) noexcept ARMCMC_NONBLOCKING;
  /// The grids, from what AccumulateSums() leaves in `scratch`.
  void TabulateProducts(const QuadraticScratch& scratch) noexcept ARMCMC_NONBLOCKING;
  /// Of what AccumulateSums() and TabulateProducts() have left.
  void ExpandInSeries(QuadraticScratch* scratch) noexcept ARMCMC_NONBLOCKING;
  /// Candidates get what the samples give.
  [[nodiscard]] bool IsConfirmed(const ModeData& data, const ParamVector& centre, const ParamVector& sd,
                                 QuadraticScratch* scratch) const noexcept ARMCMC_NONBLOCKING;
  /// Degree after which all series of one parameter may end, -1 where they do not settle.
  [[nodiscard]] int Degree(const Lines& series, double variance) const noexcept ARMCMC_NONBLOCKING;
  /// Ends every series by itself, where two parameters are curved. @return whether they settle.
  [[nodiscard]] bool EndEach(const Lines& series, double variance,
                             const ParamVector& centre) noexcept ARMCMC_NONBLOCKING;
  /// @param floor      Coefficients that are not larger count as none.
  /// @param tolerance  Of the sum of those that are left out.
  [[nodiscard]] bool EndSeries(const Lines& lines, std::size_t f, double floor,
                               double tolerance) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] static bool EndProduct(const Grid& series, double floor, double tolerance,
                                       ProductSeries* out) noexcept ARMCMC_NONBLOCKING;

  const simd::Kernels& kernels_;
  int model_;
  const ParameterSpace& space_;
  const NoiseModel& noise_;
  LinearPart part_;
  bool applies_ = false, ready_ = false;
  int nodes_ = kTileLanes;  ///< On a line; a multiple of kTileLanes.
  int num_samples_ = 0;
  QuadraticForm form_;
  const CosineTable* transform_ = nullptr;  ///< Where a parameter is curved.
  std::vector<Grid> grid_;                  ///< For each ProductSeries: sums, then series; and one more.
};

}  // namespace armcmc
