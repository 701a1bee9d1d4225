#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "armcmc/nonblocking.hpp"

namespace armcmc {

class SnapshotReader;
class SnapshotWriter;

/// A one-dimensional density on equally spaced nodes, linear in between, zero outside: it can be evaluated, and
/// drawn exactly by inverse CDF in bounded time.
class MarginalTable {
 public:
  static constexpr int kMaxNodes = 257;
  static constexpr double kNodesPerUnit = 8.0;  ///< Standardised coordinates: 8 nodes per standard deviation.
  static constexpr int kGuideSize = 4096;       ///< So many that hardly any cell of it holds a node.

  /// Standard normal on [-6, 6]: one table for the whole process, which is made at the first call.
  static const MarginalTable& Normal();
  /// Student-t on [-16, 16].
  static MarginalTable StudentT(double dof);
  /// Uniform on [-half_width, half_width], rounded outward to nodes.
  static MarginalTable Uniform(double half_width);

  /// Takes unnormalised node values pdf[0..num_nodes), scales them to a density and builds the inverse CDF.
  /// Values must be >= 0 with a positive sum. @rt O(nodes), no heap.
  void Build(const double* values, int num_nodes, double lower) noexcept ARMCMC_NONBLOCKING;

  /// Draw for a uniform u in (0, 1). @rt at most kMaxNodes steps, two on average.
  [[nodiscard]] double Draw(double u) const noexcept ARMCMC_NONBLOCKING;
  /// Density at x; 0 outside the nodes.
  [[nodiscard]] double Density(double x) const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] double Mean() const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] double Variance() const noexcept ARMCMC_NONBLOCKING;
  /// Asks for the table to be in the cache. @rt O(nodes).
  void Prefetch() const noexcept ARMCMC_NONBLOCKING;

  /// For Restore(), which is bit-identical. in->good() is false if it is not a density.
  void Save(SnapshotWriter* out) const noexcept ARMCMC_NONBLOCKING;
  void Restore(SnapshotReader* in) noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] int num_nodes() const noexcept { return num_nodes_; }
  [[nodiscard]] double lower() const noexcept { return lower_; }
  [[nodiscard]] const double* pdf() const noexcept { return pdf_.data(); }
  /// What a draw between a node and the next one takes, side by side in memory.
  struct Interval {
    double cdf, next_cdf;  ///< next_cdf is infinite in the last one: nothing is beyond it.
    double pdf, next_pdf;
  };
  [[nodiscard]] const Interval* intervals() const noexcept { return intervals_.data(); }
  /// [i], i in [0, kGuideSize): the last interval whose cdf is <= i / kGuideSize.
  [[nodiscard]] const std::uint16_t* guide() const noexcept { return guide_.data(); }

 private:
  /// Intervals and guide, from pdf_ and the CDF at the nodes.
  void Index(const double* cdf) noexcept ARMCMC_NONBLOCKING;

  int num_nodes_ = 0;
  double lower_ = 0.0;
  std::array<double, kMaxNodes> pdf_{};
  std::array<Interval, kMaxNodes - 1> intervals_{};
  std::array<std::uint16_t, kGuideSize> guide_{};
};

// Inline: called once for every coordinate of every candidate.
inline double MarginalTable::Draw(double u) const noexcept ARMCMC_NONBLOCKING {
  constexpr double kStep = 1.0 / kNodesPerUnit;
  std::size_t node = guide_[static_cast<std::size_t>(u * kGuideSize)];
  while (intervals_[node].next_cdf < u) ++node;
  // Between two nodes the density is f0 + (f1 - f0) s / h: solve its integral for the rest of the mass; this form of
  // the root has no cancellation and no division by zero for f0 = f1.
  const Interval& at = intervals_[node];
  const double f0 = at.pdf;
  const double slope = (at.next_pdf - f0) * kNodesPerUnit;
  const double rest = std::max(u - at.cdf, 0.0);
  const double root = std::sqrt(std::max(f0 * f0 + 2.0 * slope * rest, 0.0));
  const double denominator = f0 + root;
  const double s = denominator > 0.0 ? std::min(2.0 * rest / denominator, kStep) : 0.5 * kStep;
  return lower_ + static_cast<double>(node) * kStep + s;
}

}  // namespace armcmc
