#include "armcmc/density_fit.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/linear_algebra.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr int kNodes = 97;  // [-6, 6] at 8 nodes per standard deviation
constexpr double kReach = 6.0;
constexpr int kProbeDraws = 2048;
constexpr double kBendMinimumEss = 50.0;  // below, the bends would be noise

struct Moments {
  double sum = 0.0, square = 0.0;
  ParamVector mean;
  ParamMatrix covariance;
};

Moments WeightedMoments(const simd::Kernels& kernels, const WeightedDraws& draws) noexcept {
  const int dim = draws.dim;
  Moments m;
  m.mean = ParamVector::Zero(dim);
  m.covariance = ParamMatrix::Zero(dim, dim);
  std::array<double, kMaxParams*(kMaxParams + 1) / 2> sums{};
  kernels.first_moments(dim, draws.u.data(), draws.weight, draws.size, sums.data());
  m.sum = sums[0];
  m.square = sums[1];
  if (!(m.sum > 0.0)) return m;
  for (int d = 0; d < dim; ++d) m.mean[d] = sums[static_cast<std::size_t>(2 + d)] / m.sum;
  // About the mean, in a second pass: the covariance of a posterior far from the origin would cancel otherwise.
  // Unbiased for weighted draws: a recursion that lost 1 / ESS of its variance in every pack would contract by itself.
  const double unbiased = 1.0 / std::fmax(1.0 - m.square / (m.sum * m.sum), 0.5);
  kernels.second_moments(dim, draws.u.data(), draws.weight, m.mean.data(), draws.size, sums.data());
  std::size_t t = 0;
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j <= i; ++j) m.covariance(i, j) = m.covariance(j, i) = unbiased * sums[t++] / m.sum;
  return m;
}

/// Principal axes, widest first; scales of the coordinates are equalised first, so that the result does not depend
/// on how far the posterior has contracted in one of them.
void PrincipalAxes(const ParamMatrix& covariance, ParamMatrix* whiten, ParamMatrix* unwhiten) noexcept {
  const auto dim = covariance.rows();
  ParamVector sd(dim);
  for (Eigen::Index i = 0; i < dim; ++i) sd[i] = std::sqrt(std::fmax(covariance(i, i), 1e-300));
  ParamMatrix correlation(dim, dim);
  for (Eigen::Index i = 0; i < dim; ++i)
    for (Eigen::Index j = 0; j < dim; ++j) correlation(i, j) = covariance(i, j) / (sd[i] * sd[j]);
  const auto solver = SymmetricEigen(correlation);
  *whiten = ParamMatrix::Zero(dim, dim);
  *unwhiten = ParamMatrix::Zero(dim, dim);
  if (solver.info() != Eigen::Success) {
    for (Eigen::Index i = 0; i < dim; ++i) {
      (*whiten)(i, i) = 1.0 / sd[i];
      (*unwhiten)(i, i) = sd[i];
    }
    return;
  }
  for (Eigen::Index i = 0; i < dim; ++i) {
    const Eigen::Index column = dim - 1 - i;  // Eigen sorts ascending
    const double axis_sd = std::sqrt(std::fmax(solver.eigenvalues()[column], 1e-14));
    for (Eigen::Index j = 0; j < dim; ++j) {
      (*whiten)(i, j) = solver.eigenvectors()(j, column) / (axis_sd * sd[j]);
      (*unwhiten)(j, i) = solver.eigenvectors()(j, column) * axis_sd * sd[j];
    }
  }
}

/// Least-squares polynomial of z_i in the widest coordinate, for every i >= 1. `z` holds the whitened coordinates.
void FitPolynomials(const simd::Kernels& kernels, const WeightedDraws& draws, double* const* z,
                    DensityBlock* block) noexcept {
  constexpr int kPowers = DensityBlock::kDegree + 1;
  std::array<double, 2 * DensityBlock::kDegree + 1 + kPowers * kMaxParams> sums{};
  kernels.bend_moments(block->dim, z, draws.weight, draws.size, sums.data());
  Eigen::Matrix<double, kPowers, kPowers> gram;
  for (int i = 0; i < kPowers; ++i)
    for (int j = 0; j < kPowers; ++j) gram(i, j) = sums[static_cast<std::size_t>(i + j)] / sums[0];
  gram.diagonal() *= 1.0 + 1e-9;
  const auto factor = FactorSymmetric(gram);
  std::size_t t = 2 * DensityBlock::kDegree + 1;
  for (int i = 1; i < block->dim; ++i) {
    Eigen::Matrix<double, kPowers, 1> cross;
    for (int q = 0; q < kPowers; ++q) cross[q] = sums[t++] / sums[0];
    const Eigen::Matrix<double, kPowers, 1> c = Solve(factor, cross);
    if (!c.allFinite()) continue;
    for (int q = 0; q < kPowers; ++q) block->poly[static_cast<std::size_t>(i)][static_cast<std::size_t>(q)] = c[q];
  }
}

/// What is left of coordinate i >= 2 on the straightened ones before it: linear terms, e_1 c and e_1^2. `e` holds the
/// coordinates straightened so far (row i without these terms); rows `extra` are scratch.
void FitInteractions(const simd::Kernels& kernels, const WeightedDraws& draws, int i, double* const* e,
                     double* const* extra, DensityBlock* block) noexcept {
  for (int k = 0; k < draws.size; ++k) {
    extra[0][k] = e[1][k] * DensityBlock::Clamped(e[0][k]);
    extra[1][k] = e[1][k] * e[1][k];
  }
  std::array<const double*, simd::kMaxMomentRows> rows{};
  int n = 0;
  for (int j = 1; j < i; ++j) rows[static_cast<std::size_t>(n++)] = e[j];
  rows[static_cast<std::size_t>(n++)] = extra[0];
  rows[static_cast<std::size_t>(n++)] = extra[1];
  rows[static_cast<std::size_t>(n)] = e[i];
  std::array<double, 2 + simd::kMaxMomentRows> first{};
  std::array<double, simd::kMaxMomentRows> mean{};
  for (int r = 0; r <= n; ++r) {
    kernels.first_moments(1, &rows[static_cast<std::size_t>(r)], draws.weight, draws.size, first.data());
    mean[static_cast<std::size_t>(r)] = first[2] / first[0];
  }
  std::array<double, simd::kMaxMomentRows*(simd::kMaxMomentRows + 1) / 2> sums{};
  kernels.second_moments(n + 1, rows.data(), draws.weight, mean.data(), draws.size, sums.data());
  using Gram = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, simd::kMaxMomentRows, simd::kMaxMomentRows>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, simd::kMaxMomentRows, 1>;
  Gram gram(n, n);
  Vector cross(n);
  std::size_t t = 0;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b <= a; ++b) gram(a, b) = gram(b, a) = sums[t++];
  for (int a = 0; a < n; ++a) cross[a] = sums[t++];
  // Equilibrate: the rows differ by powers of a ridge's thickness.
  Vector size(n);
  for (int a = 0; a < n; ++a) size[a] = gram(a, a) > 0.0 ? 1.0 / std::sqrt(gram(a, a)) : 0.0;
  gram = Evaluate(size.asDiagonal() * gram * size.asDiagonal());
  gram.diagonal().array() += 1e-9;
  const Vector scaled = size.asDiagonal() * cross;
  Vector c = Solve(FactorSymmetric(gram), scaled);
  c = (size.asDiagonal() * c).eval();
  if (!c.allFinite()) return;
  const auto ii = static_cast<std::size_t>(i);
  for (int j = 1; j < i; ++j) block->linear[ii][static_cast<std::size_t>(j)] = c[j - 1];
  block->cross[ii] = c[n - 2];
  block->square[ii] = c[n - 1];
}

/// True when straightening took more variance out of some whitened coordinate (variance 1) than its coefficients would
/// take out of noise. `sums` are the first moments of e.
bool BendPays(const simd::Kernels& kernels, const WeightedDraws& draws, const double* sums, const double* const* e,
              const DensityBlock& block) noexcept {
  const double ess = sums[0] * sums[0] / sums[1];
  const double pays = 0.004 + 2.5 * (DensityBlock::kDegree + 1) / ess;
  for (int i = 1; i < block.dim; ++i) {
    const double* row = e[i];
    const double mean = sums[static_cast<std::size_t>(2 + i)] / sums[0];
    double square = 0.0;
    kernels.second_moments(1, &row, draws.weight, &mean, draws.size, &square);
    if (square / sums[0] < 1.0 - pays) return true;
  }
  return false;
}

/// Thickness of coordinate i along the ridge: log of the variance in bins of c, fitted by a parabola. `ess` is the
/// effective number of the draws.
void FitThickness(const WeightedDraws& draws, double ess, int i, double* const* e, DensityBlock* block) noexcept {
  constexpr int kBins = 10;
  constexpr double kEdge = 2.5;
  constexpr int kEnough = 4096;  // draws: a parabola needs no more
  const int stride = std::max(draws.size / kEnough, 1);
  std::array<double, kBins> mass{}, square{}, place{}, mean{};
  for (int k = 0; k < draws.size; k += stride) {
    const double c = DensityBlock::Clamped(e[0][k]);
    const auto bin = static_cast<std::size_t>(std::clamp((c + kEdge) * (kBins / (2.0 * kEdge)), 0.0, kBins - 1.0));
    const double w = draws.weight[k];
    mass[bin] += w;
    place[bin] += w * c;
    mean[bin] += w * e[i][k];
    square[bin] += w * e[i][k] * e[i][k];
  }
  double total = 0.0;
  for (const double m : mass) total += m;
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d cross = Eigen::Vector3d::Zero();
  int used = 0;
  for (std::size_t b = 0; b < kBins; ++b) {
    if (mass[b] < 0.01 * total) continue;
    const double c = place[b] / mass[b];
    const double variance = square[b] / mass[b] - mean[b] * mean[b] / (mass[b] * mass[b]);
    if (!(variance > 0.0)) continue;
    const Eigen::Vector3d phi(1.0, c, c * c);
    gram += mass[b] / total * phi * phi.transpose();
    cross += mass[b] / total * 0.5 * std::log(variance) * phi;
    ++used;
  }
  if (used < 4) return;
  const Eigen::Vector3d fit = Solve(FactorSymmetric(gram), cross);
  if (!fit.allFinite()) return;
  // The log of a standard deviation from n draws has variance 1 / 2n, so that without any taper twice the explained sum
  // of squares is a chi-square of two degrees of freedom, which exceeds this once in a thousand fits.
  constexpr double kSignificant = 13.8;
  const double explained = fit.dot(cross) - cross[0] * cross[0] / gram(0, 0);
  if (2.0 * ess / stride * explained < kSignificant) return;
  // A thickness that would change by more than e^2 within the reach is held to that.
  constexpr double kMost = 2.0;
  const double reach = DensityBlock::kBendReach;
  const double change = std::fabs(fit[1]) * reach + std::fabs(fit[2]) * reach * reach;
  const double keep = change > kMost ? kMost / change : 1.0;
  // A change of less than a tenth within two standard deviations is not worth an exponential for every draw.
  constexpr double kLeast = 0.1;
  if (2.0 * std::fabs(fit[1]) + 4.0 * std::fabs(fit[2]) < kLeast) return;
  block->thickness[static_cast<std::size_t>(i)] = {fit[1] * keep, fit[2] * keep};
}

/// Fits all bends and tapers. @return false, with the block left unbent, when they are not worth having.
bool FitBends(const simd::Kernels& kernels, const WeightedDraws& draws, double* const* scratch,
              DensityBlock* block) noexcept {
  const int dim = block->dim;
  block->bent = block->tapered = false;
  kernels.straighten(*block, draws.u.data(), draws.size, scratch);
  FitPolynomials(kernels, draws, scratch, block);
  block->bent = true;
  for (auto& row : block->linear) row.fill(0.0);
  block->cross.fill(0.0);
  block->square.fill(0.0);
  kernels.straighten(*block, draws.u.data(), draws.size, scratch);
  for (int i = 2; i < dim; ++i) {
    FitInteractions(kernels, draws, i, scratch, scratch + kMaxParams, block);
    kernels.straighten(*block, draws.u.data(), draws.size, scratch);
  }
  std::array<double, 2 + kMaxParams> sums{};
  kernels.first_moments(dim, scratch, draws.weight, draws.size, sums.data());
  const double ess = sums[0] * sums[0] / sums[1];
  for (int i = 1; i < dim; ++i) {
    block->thickness[static_cast<std::size_t>(i)] = {0.0, 0.0};
    FitThickness(draws, ess, i, scratch, block);
    block->tapered = block->tapered || block->Tapers(i);
  }
  block->bent = block->tapered || BendPays(kernels, draws, sums.data(), scratch, *block);
  return block->bent;
}

/// Gaussian smoothing of node masses, in place, with a kernel of standard deviation h (node units h * 8).
void Smooth(double h, std::array<double, kNodes>* values) noexcept {
  const double h_nodes = h * MarginalTable::kNodesPerUnit;
  const int reach = std::min(static_cast<int>(std::ceil(4.0 * h_nodes)), kNodes - 1);
  std::array<double, kNodes> kernel{};
  double total = 0.0;
  for (int j = 0; j <= reach; ++j) {
    const double x = j / h_nodes;
    kernel[static_cast<std::size_t>(j)] = std::exp(-0.5 * x * x);
    total += (j == 0 ? 1.0 : 2.0) * kernel[static_cast<std::size_t>(j)];
  }
  std::array<double, kNodes> out{};
  for (int i = 0; i < kNodes; ++i) {
    const double v = (*values)[static_cast<std::size_t>(i)] / total;
    if (v == 0.0) continue;
    const int from = std::max(0, i - reach);
    const int to = std::min(kNodes - 1, i + reach);
    for (int j = from; j <= to; ++j)
      out[static_cast<std::size_t>(j)] += v * kernel[static_cast<std::size_t>(j < i ? i - j : j - i)];
  }
  *values = out;
}

/// |det W| / prod scale.
void UpdateNorm(const ParamMatrix& whiten, DensityBlock* block) noexcept {
  block->norm = std::fabs(Determinant(whiten));
  for (int i = 0; i < block->dim; ++i) block->norm /= block->scale[static_cast<std::size_t>(i)];
}

void StoreAxes(const ParamMatrix& whiten, const ParamMatrix& unwhiten, DensityBlock* block) noexcept {
  for (int i = 0; i < block->dim; ++i)
    for (int j = 0; j < block->dim; ++j) {
      block->whiten[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = whiten(i, j);
      block->unwhiten[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = unwhiten(i, j);
    }
}

}  // namespace

void SetElliptic(const ParamVector& mean, const ParamMatrix& covariance, double inflation, const MarginalTable* table,
                 DensityBlock* block) noexcept {
  *block = DensityBlock{};
  block->dim = static_cast<int>(mean.size());
  ParamMatrix whiten;
  ParamMatrix unwhiten;
  PrincipalAxes(covariance, &whiten, &unwhiten);
  StoreAxes(whiten, unwhiten, block);
  for (int i = 0; i < block->dim; ++i) {
    const auto ii = static_cast<std::size_t>(i);
    block->mean[ii] = mean[i];
    block->center[ii] = 0.0;
    block->scale[ii] = inflation;
    block->marginal[ii] = table;
  }
  UpdateNorm(whiten, block);
}

void SetAxisAligned(int dim, const std::array<const MarginalTable*, kMaxParams>& tables, DensityBlock* block) noexcept {
  *block = DensityBlock{};
  block->dim = dim;
  const ParamMatrix identity = ParamMatrix::Identity(dim, dim);
  StoreAxes(identity, identity, block);
  block->scale.fill(1.0);
  block->marginal = tables;
  block->norm = 1.0;
}

ParamVector MeanOf(const DensityBlock& block) noexcept {
  ParamVector mean(block.dim);
  for (int i = 0; i < block.dim; ++i) mean[i] = block.mean[static_cast<std::size_t>(i)];
  return mean;
}

ParamMatrix CovarianceOf(const DensityBlock& block) noexcept {
  ParamMatrix a(block.dim, block.dim);
  for (int i = 0; i < block.dim; ++i)
    for (int j = 0; j < block.dim; ++j)
      a(i, j) = block.unwhiten[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return Evaluate(a * a.transpose());
}

double FitBlock(const simd::Kernels& kernels, const WeightedDraws& draws, const FitOptions& options,
                double* const* scratch, MarginalTable* tables, DensityBlock* block) noexcept {
  const Moments moments = WeightedMoments(kernels, draws);
  if (!(moments.sum > 0.0)) return 0.0;
  const double ess = moments.sum * moments.sum / moments.square;
  if (!(ess >= kMinimumEss) || !moments.mean.allFinite() || !moments.covariance.allFinite()) return ess;

  const int dim = draws.dim;
  *block = DensityBlock{};
  block->dim = dim;
  for (int d = 0; d < dim; ++d) block->mean[static_cast<std::size_t>(d)] = moments.mean[d];
  ParamMatrix whiten;
  ParamMatrix unwhiten;
  PrincipalAxes(moments.covariance, &whiten, &unwhiten);
  StoreAxes(whiten, unwhiten, block);
  if (dim > 1 && ess > kBendMinimumEss) {
    // Most posteriors are Gaussian but for noise: a part of the draws tells whether bends pay.
    WeightedDraws probe = draws;
    probe.size = std::min(draws.size, kProbeDraws);
    if (FitBends(kernels, probe, scratch, block) && probe.size < draws.size)
      (void)FitBends(kernels, draws, scratch, block);
  }
  kernels.straighten(*block, draws.u.data(), draws.size, scratch);
  for (int i = 1; i < dim; ++i) {
    if (!block->tapered || !block->Tapers(i)) continue;
    double* const row = scratch[i];
    for (int k = 0; k < draws.size; ++k)
      row[k] *= std::exp(-block->LogThickness(i, DensityBlock::Clamped(scratch[0][k])));
  }
  // Histograms of the straightened coordinates with linear (cloud-in-cell) binning.
  std::array<double, 2 + kMaxParams> sums{};
  std::array<double, kMaxParams> first{}, sd{};
  kernels.first_moments(dim, scratch, draws.weight, draws.size, sums.data());
  for (int i = 0; i < dim; ++i)
    first[static_cast<std::size_t>(i)] = sums[static_cast<std::size_t>(2 + i)] / moments.sum;
  std::array<std::array<double, kNodes>, kMaxParams> histogram{};
  for (int i = 0; i < dim; ++i) {
    const auto ii = static_cast<std::size_t>(i);
    const double* e = scratch[i];
    double square = 0.0;
    kernels.second_moments(1, &e, draws.weight, &first[ii], draws.size, &square);
    const double freedom = block->bent && i > 0 ? DensityBlock::kDegree + 1.0 : 1.0;
    sd[ii] = std::sqrt(std::fmax(square / moments.sum / std::fmax(1.0 - freedom / ess, 0.5), 1e-12));
    const double per_node = MarginalTable::kNodesPerUnit / sd[ii];
    const double origin = kReach * MarginalTable::kNodesPerUnit - first[ii] * per_node;
    struct Bin {
      double weight = 0.0,
             upper = 0.0;  // of the draws in a cell, and the part of it that goes to the cell's upper node
    };
    std::array<Bin, kNodes> bins{};
    for (int k = 0; k < draws.size; ++k) {
      const double position = std::min(std::max(0.0, e[k] * per_node + origin), kNodes - 1.001);
      const auto node = static_cast<int>(position);
      Bin& bin = bins[static_cast<std::size_t>(node)];
      bin.weight += draws.weight[k];
      bin.upper += draws.weight[k] * (position - node);
    }
    for (std::size_t n = 0; n + 1 < kNodes; ++n) {
      histogram[ii][n] += bins[n].weight - bins[n].upper;
      histogram[ii][n + 1] += bins[n].upper;
    }
  }
  const double bandwidth = options.bandwidth_factor * 1.06 * std::pow(ess, -0.2);
  for (int i = 0; i < dim; ++i) {
    const auto ii = static_cast<std::size_t>(i);
    Smooth(bandwidth, &histogram[ii]);
    for (int n = 0; n < kNodes; ++n) {
      const double x = n / MarginalTable::kNodesPerUnit - kReach;
      const double tail = std::exp(-0.5 * x * x / (options.tail_sd * options.tail_sd)) /
                          (options.tail_sd * 2.5066282746310002 * MarginalTable::kNodesPerUnit);
      auto& value = histogram[ii][static_cast<std::size_t>(n)];
      value = (1.0 - options.tail_weight) * value / moments.sum + options.tail_weight * tail;
    }
    tables[i].Build(histogram[ii].data(), kNodes, -kReach);
    block->marginal[ii] = &tables[i];
    // Standardise: the tabulated law gets exactly the mean and standard deviation of the draws.
    const double table_sd = std::sqrt(tables[i].Variance());
    block->scale[ii] = sd[ii] * options.inflation / table_sd;
    block->center[ii] = first[ii] - block->scale[ii] * tables[i].Mean();
  }
  UpdateNorm(whiten, block);
  return ess;
}

}  // namespace armcmc
