#pragma once

#include <array>
#include <string>
#include <vector>

#include "armcmc/estimate.hpp"
#include "armcmc/tables/coverage.hpp"
#include "armcmc/tables/method.hpp"
#include "armcmc/tables/recording.hpp"

namespace armcmc::tables {

/// State of one mode after a pack: estimates, intervals, drift.
struct ModeTrace {
  bool any = false;      ///< Some pack has updated the mode.
  bool known = false;    ///< Some parameter is known better than its prior says.
  bool updated = false;  ///< By this pack.
  std::array<double, 3> map{}, ap{}, sd{};
  std::array<std::array<std::array<double, 2>, 3>, 3> interval{};  ///< [level][parameter] from, to.
  double p_drifted = 0.0;                                          ///< Posterior probability that the parameters drift.
  std::array<double, 3> drift_rate{};                              ///< And how fast, unit of the parameter per s.
};

struct PackTrace {
  std::array<ModeTrace, 2> modes;
  int decision = 0;  ///< Of the mode that acts; Decision as a number.
  double zeta = 0.0, lambda = 0.0, ms = 0.0;
  int draws = 0;
  std::array<MarginalSummary, 3> marginal{};  ///< Of mode 0, for the density plots.
};

/// A method's run over a recording. Element k - 1 of packs is pack k, shown to the user during
/// [k N + N, k N + 2 N) samples: one period to compute, one on display, as in the paper.
struct Trace {
  std::string key, label;
  int pack_samples = 100;
  bool online = true, has_intervals = true;
  std::vector<PackTrace> packs;
  /// What is on display at a sample; nullptr before the first estimate.
  [[nodiscard]] const PackTrace* ShownAt(std::size_t sample) const;
};

/// Runs an online method, without a deadline.
[[nodiscard]] Trace RunMethod(const Recording& recording, const MethodSpec& spec);

/// Bounded non-linear least squares on all contact data so far, by a search in p with K and B solved for exactly.
[[nodiscard]] Trace RunBatch(const Recording& recording, const MethodSpec& spec);

}  // namespace armcmc::tables
