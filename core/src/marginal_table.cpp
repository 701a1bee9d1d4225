#include "armcmc/marginal_table.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/prefetch.hpp"
#include "armcmc/snapshot.hpp"

namespace armcmc {
namespace {

constexpr double kNodeStep = 1.0 / MarginalTable::kNodesPerUnit;

template <class F>
MarginalTable Tabulate(double half_width, F density) {
  std::array<double, MarginalTable::kMaxNodes> values{};
  constexpr int kMostHalf = (MarginalTable::kMaxNodes - 1) / 2;
  const int half = static_cast<int>(std::fmin(std::ceil(half_width * MarginalTable::kNodesPerUnit - 1e-9), kMostHalf));
  for (int i = 0; i <= 2 * half; ++i) values[static_cast<std::size_t>(i)] = density((i - half) * kNodeStep);
  MarginalTable table;
  table.Build(values.data(), 2 * half + 1, -half * kNodeStep);
  return table;
}

}  // namespace

const MarginalTable& MarginalTable::Normal() {
  static const MarginalTable table = Tabulate(6.0, [](double x) { return std::exp(-0.5 * x * x); });
  return table;
}

MarginalTable MarginalTable::StudentT(double dof) {
  return Tabulate(16.0, [dof](double x) { return std::pow(1.0 + x * x / dof, -0.5 * (dof + 1.0)); });
}

MarginalTable MarginalTable::Uniform(double half_width) {
  return Tabulate(half_width, [](double) { return 1.0; });
}

void MarginalTable::Build(const double* values, int num_nodes, double lower) noexcept ARMCMC_NONBLOCKING {
  num_nodes_ = std::clamp(num_nodes, 2, kMaxNodes);
  lower_ = lower;
  std::array<double, kMaxNodes> cdf;
  double mass = 0.0;
  cdf[0] = 0.0;
  for (int i = 1; i < num_nodes_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    mass += 0.5 * kNodeStep * (values[i - 1] + values[i]);
    cdf[k] = mass;
  }
  const double scale = 1.0 / mass;
  for (int i = 0; i < num_nodes_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    pdf_[k] = values[i] * scale;
    cdf[k] *= scale;
  }
  Index(cdf.data());
}

void MarginalTable::Index(const double* cdf) noexcept {
  const int last = num_nodes_ - 2;
  for (int i = 0; i <= last; ++i) {
    const auto k = static_cast<std::size_t>(i);
    intervals_[k] = {cdf[k], i < last ? cdf[k + 1] : HUGE_VAL, pdf_[k], pdf_[k + 1]};
  }
  int from = 0;  // first entry not yet written
  for (int i = 0; i <= last; ++i) {
    const double end = i < last ? cdf[i + 1] * kGuideSize : kGuideSize;
    const int to = static_cast<int>(std::fmin(std::fmax(std::ceil(end), from), kGuideSize));
    std::fill(guide_.begin() + from, guide_.begin() + to, static_cast<std::uint16_t>(i));
    from = to;
  }
}

void MarginalTable::Prefetch() const noexcept {
  const auto nodes = static_cast<std::size_t>(num_nodes_);
  armcmc::Prefetch(pdf_.data(), nodes * sizeof(double));
  armcmc::Prefetch(intervals_.data(), nodes * sizeof(Interval));
  armcmc::Prefetch(guide_.data(), sizeof guide_);
}

void MarginalTable::Save(SnapshotWriter* out) const noexcept {
  const auto nodes = static_cast<std::size_t>(num_nodes_);
  out->Put(std::int64_t{num_nodes_});
  out->Put(lower_);
  out->PutRow(pdf_.data(), nodes);
  std::array<double, kMaxNodes> cdf;
  for (std::size_t n = 0; n + 1 < nodes; ++n) cdf[n] = intervals_[n].cdf;
  cdf[nodes - 1] = 1.0;
  out->PutRow(cdf.data(), nodes);
}

void MarginalTable::Restore(SnapshotReader* in) noexcept {
  num_nodes_ = static_cast<int>(in->Integer(2, kMaxNodes));
  lower_ = in->Number();
  const auto nodes = static_cast<std::size_t>(num_nodes_);
  std::array<double, kMaxNodes> cdf{};
  in->Row(pdf_.data(), nodes);
  in->Row(cdf.data(), nodes);
  in->Require(cdf[0] == 0.0 && std::fabs(cdf[nodes - 1] - 1.0) < 1e-9);
  for (std::size_t n = 0; n < nodes; ++n) in->Require(pdf_[n] >= 0.0 && (n == 0 || cdf[n] >= cdf[n - 1]));
  Index(cdf.data());
}

double MarginalTable::Density(double x) const noexcept ARMCMC_NONBLOCKING {
  const double position = (x - lower_) * kNodesPerUnit;
  if (!(position >= 0.0) || position >= num_nodes_ - 1) return 0.0;
  const auto node = static_cast<std::size_t>(position);
  const double part = position - static_cast<double>(node);
  return pdf_[node] + part * (pdf_[node + 1] - pdf_[node]);
}

double MarginalTable::Mean() const noexcept {
  double sum = 0.0;
  for (int i = 0; i < num_nodes_; ++i) {
    const double x = lower_ + i * kNodeStep;
    const double ends = (i == 0 || i == num_nodes_ - 1) ? 0.5 : 1.0;
    // Exact for interior nodes: the mean of a hat function is its node; at the ends the half hat leans inward.
    const double lean = i == 0 ? kNodeStep / 3.0 : (i == num_nodes_ - 1 ? -kNodeStep / 3.0 : 0.0);
    sum += ends * pdf_[static_cast<std::size_t>(i)] * kNodeStep * (x + lean);
  }
  return sum;
}

double MarginalTable::Variance() const noexcept {
  const double mean = Mean();
  double sum = 0.0;
  for (int i = 0; i < num_nodes_; ++i) {
    const double ends = (i == 0 || i == num_nodes_ - 1) ? 0.5 : 1.0;
    const double lean = i == 0 ? kNodeStep / 3.0 : (i == num_nodes_ - 1 ? -kNodeStep / 3.0 : 0.0);
    const double x = lower_ + i * kNodeStep - mean;
    // Second moment of a hat about its node: h^2 / 6; of a half hat about its edge: also h^2 / 6.
    sum +=
        ends * pdf_[static_cast<std::size_t>(i)] * kNodeStep * (x * x + 2.0 * x * lean + kNodeStep * kNodeStep / 6.0);
  }
  return sum;
}

}  // namespace armcmc
