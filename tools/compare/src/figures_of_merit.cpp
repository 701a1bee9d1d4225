#include "figures_of_merit.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace armcmc::compare {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::vector<double> Finite(const std::vector<double>& values) {
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite), [](double v) { return std::isfinite(v); });
  return finite;
}

double Median(const std::vector<double>& values) {
  std::vector<double> finite = Finite(values);
  if (finite.empty()) return kNone;
  const auto middle = finite.begin() + static_cast<std::ptrdiff_t>(finite.size() / 2);
  std::nth_element(finite.begin(), middle, finite.end());
  return *middle;
}

double Largest(const std::vector<double>& values) {
  const std::vector<double> finite = Finite(values);
  return finite.empty() ? kNone : *std::max_element(finite.begin(), finite.end());
}

const QuantityTrace* Known(const RunTrace& run, const QuantityTrace& like) {
  for (const QuantityTrace& q : run.quantities)
    if (q.name == like.name && q.mode == like.mode && !q.t.empty()) return &q;
  return nullptr;
}

}  // namespace

std::vector<MeritRow> FiguresOfMerit(const RunTrace& a, const RunTrace& b) {
  const auto count = [](std::int64_t n) { return static_cast<double>(n); };
  return {
      {"residual of the " + a.output_name + ", rms", a.output_unit, a.residual_rms(), b.residual_rms()},
      {"log evidence, all packs", "nat", a.total_log_evidence(), b.total_log_evidence()},
      {"packs used", "", count(a.summary.packs), count(b.summary.packs)},
      {"packs that changed nothing", "", count(a.summary.held), count(b.summary.held)},
      {"modifications", "", count(a.summary.modifications), count(b.summary.modifications)},
      {"draws a pack, median", "", Median(a.draws), Median(b.draws)},
      {"k_min, median", "", Median(a.k_min), Median(b.k_min)},
      {"effective sample size, median", "", Median(a.ess), Median(b.ess)},
      {"lambda, median", "", Median(a.lambda), Median(b.lambda)},
      {"computing time a pack, median", "ms", Median(a.compute_ms), Median(b.compute_ms)},
      {"computing time a pack, largest", "ms", Largest(a.compute_ms), Largest(b.compute_ms)},
  };
}

double EstimatePair::distance() const {
  if (a == nullptr || b == nullptr) return kNone;
  const double sd = std::hypot(a->last_sd, b->last_sd);
  return sd > 0.0 ? (b->last - a->last) / sd : kNone;
}

std::vector<EstimatePair> PairsOf(const RunTrace& a, const RunTrace& b) {
  std::vector<EstimatePair> pairs;
  for (const QuantityTrace& q : a.quantities)
    if (Known(a, q) != nullptr) pairs.push_back({&q, Known(b, q)});
  for (const QuantityTrace& q : b.quantities)
    if (Known(b, q) != nullptr && Known(a, q) == nullptr) pairs.push_back({nullptr, &q});
  return pairs;
}

}  // namespace armcmc::compare
