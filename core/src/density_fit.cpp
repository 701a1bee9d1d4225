#include "armcmc/density_fit.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/linear_algebra.hpp"
#include "bend_fit.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr int kNodes = 97;  // [-6, 6] at 8 nodes per standard deviation
constexpr double kReach = 6.0;
constexpr int kProbeDraws = 4096;
constexpr double kBendMinimumEss = 50.0;  // below this, fitted bends would be noise

struct Moments {
  double sum = 0.0, square = 0.0;
  ParamVector mean;
  ParamMatrix covariance;
};

Moments WeightedMoments(const simd::Kernels& kernels, const WeightedDraws& draws, double mean_freedom) noexcept {
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
  // Unbiased for weighted draws: a recursion that lost 1 / ESS of its variance in every pack would contract.
  const double unbiased = 1.0 / std::fmax(1.0 - mean_freedom * m.square / (m.sum * m.sum), 0.5);
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
  const SymmetricEigen eigen = EigenOfSymmetric(correlation);
  *whiten = ParamMatrix::Zero(dim, dim);
  *unwhiten = ParamMatrix::Zero(dim, dim);
  if (!eigen.converged) {
    for (Eigen::Index i = 0; i < dim; ++i) {
      (*whiten)(i, i) = 1.0 / sd[i];
      (*unwhiten)(i, i) = sd[i];
    }
    return;
  }
  for (Eigen::Index i = 0; i < dim; ++i) {
    const Eigen::Index column = dim - 1 - i;  // Eigen sorts ascending
    const double axis_sd = std::sqrt(std::fmax(eigen.values[column], 1e-14));
    for (Eigen::Index j = 0; j < dim; ++j) {
      (*whiten)(i, j) = eigen.vectors(j, column) / (axis_sd * sd[j]);
      (*unwhiten)(j, i) = eigen.vectors(j, column) * axis_sd * sd[j];
    }
  }
}

/// exp(-n^2 h^2 / 2) for n = 0 .. size - 1: the ratios of neighbours are a geometric sequence, so that two
/// exponentials suffice for all.
void TabulateBell(double h, int size, double* bell) noexcept {
  double value = 1.0;
  double factor = std::exp(-0.5 * h * h);
  const double change = factor * factor;
  for (int n = 0; n < size; ++n) {
    bell[n] = value;
    value *= factor;
    factor *= change;
  }
}

/// Masses of a normal law at the nodes.
std::array<double, kNodes> NormalMasses(double sd) noexcept {
  constexpr std::size_t kCentre = kNodes / 2;
  std::array<double, kCentre + 1> bell;
  TabulateBell(1.0 / (sd * MarginalTable::kNodesPerUnit), kCentre + 1, bell.data());
  const double scale = 1.0 / (sd * 2.5066282746310002 * MarginalTable::kNodesPerUnit);
  std::array<double, kNodes> mass;
  for (std::size_t n = 0; n <= kCentre; ++n) mass[kCentre + n] = mass[kCentre - n] = scale * bell[n];
  return mass;
}

/// Gaussian smoothing of node masses, in place, with a kernel of standard deviation h (node units h * 8).
void Smooth(double h, std::array<double, kNodes>* values) noexcept {
  const double h_nodes = h * MarginalTable::kNodesPerUnit;
  const int reach = std::min(static_cast<int>(std::ceil(4.0 * h_nodes)), kNodes - 1);
  std::array<double, kNodes> kernel;
  TabulateBell(1.0 / h_nodes, reach + 1, kernel.data());
  double total = kernel[0];
  for (int j = 1; j <= reach; ++j) total += 2.0 * kernel[static_cast<std::size_t>(j)];
  std::array<double, kNodes> out{};
  for (int i = 0; i < kNodes; ++i) {
    const double v = (*values)[static_cast<std::size_t>(i)] / total;
    if (v == 0.0) continue;
    double* const at = &out[static_cast<std::size_t>(i)];
    const int below = std::min(reach, i);
    const int above = std::min(reach, kNodes - 1 - i);
    for (int j = 1; j <= below; ++j) at[-j] += v * kernel[static_cast<std::size_t>(j)];
    for (int j = 0; j <= above; ++j) at[j] += v * kernel[static_cast<std::size_t>(j)];
  }
  *values = out;
}

/// Weight of a histogram in a mixture with a normal law: 0 if its skewness and kurtosis are within the sampling error
/// of a normal law, near 1 if they are well beyond it. The significant share of both:
///
///   max(0, 1 - 2 / chi^2),   chi^2 = ESS (skewness^2 / 6 + excess^2 / 24), with mean 2 under a normal law
///
/// The roughness of a histogram would enter every later posterior as prior, which harms the recursion more than the
/// loss of shape.
double HistogramWeight(const std::array<double, kNodes>& mass, double total, double ess) noexcept {
  double skewness = 0.0;
  double kurtosis = 0.0;
  for (int n = 0; n < kNodes; ++n) {
    const double x = n / MarginalTable::kNodesPerUnit - kReach;
    const double cubed = mass[static_cast<std::size_t>(n)] / total * x * x * x;
    skewness += cubed;
    kurtosis += cubed * x;
  }
  const double excess = kurtosis - 3.0;
  const double chi_square = ess * (skewness * skewness / 6.0 + excess * excess / 24.0);
  return chi_square > 2.0 ? 1.0 - 2.0 / chi_square : 0.0;
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
  block->axis_aligned = true;
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
  return TimesOwnTranspose(a);
}

double FitBlock(const simd::Kernels& kernels, const WeightedDraws& draws, const FitOptions& options,
                double* const* scratch, MarginalTable* tables, DensityBlock* block) noexcept {
  const Moments moments = WeightedMoments(kernels, draws, options.mean_freedom);
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
  bool straight = false;  // the scratch holds the straightened coordinates
  if (dim > 1 && ess > kBendMinimumEss) {
    // Most posteriors are Gaussian up to noise: a part of the draws shows whether bends are needed.
    WeightedDraws probe = draws;
    probe.size = std::min(draws.size, kProbeDraws);
    straight = FitBends(kernels, probe, scratch, block) &&
               (probe.size == draws.size || FitBends(kernels, draws, scratch, block));
  }
  if (!straight) kernels.straighten(*block, draws.u.data(), draws.size, scratch);
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
    const double freedom = options.mean_freedom + (block->bent && i > 0 ? DensityBlock::kDegree : 0);
    sd[ii] = std::sqrt(std::fmax(square / moments.sum / std::fmax(1.0 - freedom / ess, 0.5), 1e-12));
    const double per_node = MarginalTable::kNodesPerUnit / sd[ii];
    const double origin = kReach * MarginalTable::kNodesPerUnit - first[ii] * per_node;
    std::array<double, 2 * kNodes> cells{};
    kernels.histogram(e, draws.weight, draws.size, per_node, origin, kNodes, cells.data());
    for (std::size_t n = 0; n + 1 < kNodes; ++n) {
      histogram[ii][n] += cells[2 * n] - cells[2 * n + 1];
      histogram[ii][n + 1] += cells[2 * n + 1];
    }
  }
  const double bandwidth = options.bandwidth_factor * 1.06 * std::pow(ess, -0.2);
  const std::array<double, kNodes> normal = NormalMasses(1.0);
  const std::array<double, kNodes> tail = NormalMasses(options.tail_sd);
  for (int i = 0; i < dim; ++i) {
    const auto ii = static_cast<std::size_t>(i);
    const double own = options.shrink_to_normal ? HistogramWeight(histogram[ii], moments.sum, ess) : 1.0;
    Smooth(bandwidth, &histogram[ii]);
    for (std::size_t n = 0; n < kNodes; ++n) {
      auto& value = histogram[ii][n];
      const double shape = own * value / moments.sum + (1.0 - own) * normal[n];
      value = (1.0 - options.tail_weight) * shape + options.tail_weight * tail[n];
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

void AppendIndependent(double mean, double sd, const MarginalTable& law, MarginalTable* table,
                       DensityBlock* block) noexcept {
  const auto i = static_cast<std::size_t>(block->dim++);
  *table = law;
  block->mean[i] = mean;
  block->whiten[i][i] = 1.0 / sd;
  block->unwhiten[i][i] = sd;
  block->marginal[i] = table;
  block->scale[i] = 1.0 / std::sqrt(law.Variance());
  block->center[i] = -block->scale[i] * law.Mean();
  block->norm /= sd * block->scale[i];
}

}  // namespace armcmc
