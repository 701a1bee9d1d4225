#include "bend_fit.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/linear_algebra.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

/// Least-squares polynomial of z_i in the widest coordinate, for every i >= 1. `z` holds the whitened coordinates.
void FitPolynomials(const simd::Kernels& kernels, const WeightedDraws& draws, double* const* z,
                    DensityBlock* block) noexcept {
  constexpr int kPowers = DensityBlock::kDegree + 1;
  std::array<double, 2 * DensityBlock::kDegree + 1 + kPowers * kMaxParams> sums{};
  kernels.bend_moments(block->dim, z, draws.weight, draws.size, sums.data());
  static_assert(kPowers <= kMaxParams);
  ParamMatrix gram(kPowers, kPowers);
  for (int i = 0; i < kPowers; ++i)
    for (int j = 0; j < kPowers; ++j) gram(i, j) = sums[static_cast<std::size_t>(i + j)] / sums[0];
  gram.diagonal() *= 1.0 + 1e-9;
  const SymmetricFactor factor(gram);
  std::size_t t = 2 * DensityBlock::kDegree + 1;
  for (int i = 1; i < block->dim; ++i) {
    ParamVector cross(kPowers);
    for (int q = 0; q < kPowers; ++q) cross[q] = sums[t++] / sums[0];
    const ParamVector c = factor.Solve(cross);
    if (!c.allFinite()) continue;
    for (int q = 0; q < kPowers; ++q) block->poly[static_cast<std::size_t>(i)][static_cast<std::size_t>(q)] = c[q];
  }
}

/// Regresses each coordinate i >= 2 on the straightened ones before it: linear terms, e_1 c and e_1^2. `e` receives the
/// residuals; rows `extra` are scratch.
///
/// One pass over the draws: once row i of their covariance is straight, the regression of row i + 1 is algebraic.
void FitInteractions(const simd::Kernels& kernels, const WeightedDraws& draws, double* const* e, double* const* extra,
                     DensityBlock* block) noexcept {
  const int straight = block->dim - 1;  // rows of the covariance: e_1 .. e_straight, e_1 c, e_1^2
  const int count = straight + 2;
  for (int k = 0; k < draws.size; ++k) {
    extra[0][k] = e[1][k] * DensityBlock::Clamped(e[0][k]);
    extra[1][k] = e[1][k] * e[1][k];
  }
  std::array<const double*, simd::kMaxMomentRows> rows{};
  std::copy_n(e + 1, straight, rows.begin());
  std::copy_n(extra, 2, rows.begin() + straight);
  std::array<double, 2 + kMaxParams> first{};
  std::array<double, simd::kMaxMomentRows> mean{};
  for (int from = 0; from < count; from += kMaxParams) {
    const int several = std::min(kMaxParams, count - from);
    kernels.first_moments(several, &rows[static_cast<std::size_t>(from)], draws.weight, draws.size, first.data());
    for (int r = 0; r < several; ++r)
      mean[static_cast<std::size_t>(from + r)] = first[static_cast<std::size_t>(2 + r)] / first[0];
  }
  std::array<double, simd::kMaxMomentRows*(simd::kMaxMomentRows + 1) / 2> sums{};
  kernels.second_moments(count, rows.data(), draws.weight, mean.data(), draws.size, sums.data());
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, simd::kMaxMomentRows, simd::kMaxMomentRows>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, simd::kMaxMomentRows, 1>;
  Square covariance(count, count);
  std::size_t t = 0;
  for (int a = 0; a < count; ++a)
    for (int b = 0; b <= a; ++b) covariance(a, b) = covariance(b, a) = sums[t++];
  for (int i = 2; i < block->dim; ++i) {
    const int row = i - 1;  // row of coordinate i
    const int n = i + 1;    // regressors: e_1 .. e_{i-1}, e_1 c, e_1^2
    const auto regressor = [&](int a) noexcept { return a < row ? a : straight + a - row; };
    // Equilibrate: the rows differ by powers of a ridge's thickness.
    Vector size(n);
    for (int a = 0; a < n; ++a) {
      const double square = covariance(regressor(a), regressor(a));
      size[a] = square > 0.0 ? 1.0 / std::sqrt(square) : 0.0;
    }
    ParamMatrix gram(n, n);
    ParamVector cross(n);
    for (int a = 0; a < n; ++a) {
      for (int b = 0; b < n; ++b) gram(a, b) = size[a] * covariance(regressor(a), regressor(b)) * size[b];
      gram(a, a) += 1e-9;
      cross[a] = size[a] * covariance(regressor(a), row);
    }
    ParamVector c = SymmetricFactor(gram).Solve(cross);
    for (int a = 0; a < n; ++a) c[a] *= size[a];
    if (!c.allFinite()) continue;
    const auto ii = static_cast<std::size_t>(i);
    for (int j = 1; j < i; ++j) block->linear[ii][static_cast<std::size_t>(j)] = c[j - 1];
    block->cross[ii] = c[n - 2];
    block->square[ii] = c[n - 1];
    for (int b = 0; b < count; ++b)
      for (int a = 0; a < n; ++a) covariance(row, b) -= c[a] * covariance(regressor(a), b);
    for (int b = 0; b < count; ++b)
      for (int a = 0; a < n; ++a) covariance(b, row) -= c[a] * covariance(b, regressor(a));
  }
}

/// Sample variances of the coordinates i >= 1 that the rows hold.
std::array<double, kMaxParams> Variances(const simd::Kernels& kernels, const WeightedDraws& draws,
                                         const double* const* rows) noexcept {
  std::array<double, 2 + kMaxParams> sums{};
  kernels.first_moments(draws.dim, rows, draws.weight, draws.size, sums.data());
  std::array<double, kMaxParams> variances{};
  for (int i = 1; i < draws.dim; ++i) {
    const double mean = sums[static_cast<std::size_t>(2 + i)] / sums[0];
    double& variance = variances[static_cast<std::size_t>(i)];
    kernels.second_moments(1, rows + i, draws.weight, &mean, draws.size, &variance);
    variance /= sums[0];
  }
  return variances;
}

/// True if straightening removed more variance from some coordinate than its coefficients would remove from noise. Both
/// variances are of the same draws: between different sets of a few thousand they vary by more than a bend removes.
bool BendReducesVariance(const std::array<double, kMaxParams>& before, const std::array<double, kMaxParams>& after,
                         int dim, double ess) noexcept {
  for (int i = 1; i < dim; ++i) {
    const int coefficients = DensityBlock::kDegree + 1 + (i > 1 ? i + 1 : 0);
    const double pays = 0.004 + 2.5 * coefficients / ess;
    const auto ii = static_cast<std::size_t>(i);
    if (after[ii] < before[ii] * (1.0 - pays)) return true;
  }
  return false;
}

/// Stores a parabola for the log of the thickness, fitted to `draws` effective draws, if it is significant.
void SetThickness(const Eigen::Vector3d& fit, double explained, double draws, int i, DensityBlock* block) noexcept {
  // The log of a standard deviation from n draws has variance 1 / 2n, so that without any taper twice the explained sum
  // of squares is a chi-square of two degrees of freedom, which exceeds this once in a thousand fits.
  constexpr double kSignificant = 13.8;
  if (2.0 * draws * explained < kSignificant) return;
  // The change of the thickness within the reach is limited to a factor of e^2.
  constexpr double kMost = 2.0;
  const double reach = DensityBlock::kTaperReach;
  const double change = std::fabs(fit[1]) * reach + std::fabs(fit[2]) * reach * reach;
  const double keep = change > kMost ? kMost / change : 1.0;
  // A change of less than a tenth within two standard deviations does not justify an exponential per draw.
  constexpr double kLeast = 0.1;
  if (2.0 * std::fabs(fit[1]) + 4.0 * std::fabs(fit[2]) < kLeast) return;
  block->thickness[static_cast<std::size_t>(i)] = {fit[1] * keep, fit[2] * keep};
}

/// Thickness of the coordinates i >= 1 along the ridge: log of the variance in bins of c, fitted by a parabola. `ess`
/// is the effective number of the draws.
void FitThickness(const WeightedDraws& draws, double ess, double* const* e, DensityBlock* block) noexcept {
  constexpr int kBins = 10;
  constexpr double kEdge = 2.5;
  constexpr int kEnough = 4096;  // draws: a parabola needs no more
  struct Bin {
    double mass = 0.0, place = 0.0;
    std::array<double, kMaxParams> mean{}, square{};
  };
  const int stride = std::max(draws.size / kEnough, 1);
  std::array<Bin, kBins> bins{};
  for (int k = 0; k < draws.size; k += stride) {
    const double c = DensityBlock::ClampedForTaper(e[0][k]);
    Bin& bin = bins[static_cast<std::size_t>(std::clamp((c + kEdge) * (kBins / (2.0 * kEdge)), 0.0, kBins - 1.0))];
    const double w = draws.weight[k];
    bin.mass += w;
    bin.place += w * c;
    for (int i = 1; i < block->dim; ++i) {
      const double we = w * e[i][k];
      bin.mean[static_cast<std::size_t>(i)] += we;
      bin.square[static_cast<std::size_t>(i)] += we * e[i][k];
    }
  }
  double total = 0.0;
  for (const Bin& bin : bins) total += bin.mass;
  for (int i = 1; i < block->dim; ++i) {
    const auto ii = static_cast<std::size_t>(i);
    Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
    Eigen::Vector3d cross = Eigen::Vector3d::Zero();
    int used = 0;
    for (const Bin& bin : bins) {
      if (bin.mass < 0.01 * total) continue;
      const double c = bin.place / bin.mass;
      const double mean = bin.mean[ii] / bin.mass;
      const double variance = bin.square[ii] / bin.mass - mean * mean;
      if (!(variance > 0.0)) continue;
      const Eigen::Vector3d phi(1.0, c, c * c);
      gram += bin.mass / total * phi * phi.transpose();
      cross += bin.mass / total * 0.5 * std::log(variance) * phi;
      ++used;
    }
    if (used < 4) continue;
    const Eigen::Vector3d fit = SymmetricFactor(gram).Solve(cross);
    if (fit.allFinite()) SetThickness(fit, fit.dot(cross) - cross[0] * cross[0] / gram(0, 0), ess / stride, i, block);
  }
}

}  // namespace

bool FitBends(const simd::Kernels& kernels, const WeightedDraws& draws, double* const* scratch,
              DensityBlock* block) noexcept {
  const int dim = block->dim;
  std::array<double, 2> sums{};
  kernels.first_moments(0, nullptr, draws.weight, draws.size, sums.data());
  const double ess = sums[0] * sums[0] / sums[1];
  block->bent = block->tapered = false;
  kernels.straighten(*block, draws.u.data(), draws.size, scratch);
  const std::array<double, kMaxParams> before = Variances(kernels, draws, scratch);
  FitPolynomials(kernels, draws, scratch, block);
  block->bent = true;
  for (auto& row : block->linear) row.fill(0.0);
  block->cross.fill(0.0);
  block->square.fill(0.0);
  kernels.straighten(*block, draws.u.data(), draws.size, scratch);
  if (dim > 2) {
    FitInteractions(kernels, draws, scratch, scratch + kMaxParams, block);
    kernels.straighten(*block, draws.u.data(), draws.size, scratch);
  }
  for (auto& thickness : block->thickness) thickness = {0.0, 0.0};
  FitThickness(draws, ess, scratch, block);
  for (int i = 1; i < dim; ++i) block->tapered = block->tapered || block->Tapers(i);
  block->bent = block->tapered || BendReducesVariance(before, Variances(kernels, draws, scratch), dim, ess);
  return block->bent;
}

}  // namespace armcmc
