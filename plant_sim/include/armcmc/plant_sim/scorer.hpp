#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "armcmc/plant_sim/simulation.hpp"

namespace armcmc::plant_sim {

/// What an estimator said after one pack, in the family's order of modes and parameters.
struct ReceivedEstimate {
  std::int64_t seq = 0;
  double arrival_s = 0.0;  ///< Plant time at which it arrived.
  std::array<bool, kMaxModes> known{};
  std::array<Theta, kMaxModes> theta{};
  int interval_mode = -1;  ///< Mode of the interval below, -1 without one.
  Theta lo{}, hi{};        ///< 95 % credible interval of each parameter.
};

/// Since when an estimate counts.
enum class Convention : std::uint8_t {
  kOnePackLater,  ///< The paper's: the estimate from the pack that ends at t is shown from t + T_s on, or from its
                  ///< arrival.
  kFromArrival,   ///< From its arrival on.
};

/// Errors of one parameter in one mode, over the samples in which that mode acts.
struct ParameterScore {
  double mae = 0.0;          ///< Before anything is known the estimate counts as 0.
  double mae_active = 0.0;   ///< Over the samples for which an estimate is shown.
  double rel_active = 0.0;   ///< Mean |error| over mean |truth|, over the same samples.
  double final_value = 0.0;  ///< The last one shown.
  std::int64_t samples = 0, active_samples = 0;
};

struct Score {
  std::vector<std::vector<ParameterScore>> modes;  ///< [mode][parameter].
  double target_mae_in_mode = 0.0;  ///< Regression target predicted from the shown parameters, against the truth.
  double target_mae_overall = 0.0;
  double target_noisy_l2 = 0.0;  ///< L2 norm of the error against the measured target.
  double target_rel_l2 = 0.0;    ///< L2 norm of the error against the true target, over that of the target.
  std::int64_t samples = 0, in_mode_samples = 0;
};

/// Scores estimates against the truth, sample by sample. It runs its own simulation of the scenario: nothing that
/// the estimator receives comes from here, and nothing here comes from the estimator but its estimates.
class Scorer {
 public:
  Scorer(const Scenario& scenario, std::uint64_t seed);

  /// Takes an estimate. Only samples after `arrival_s` are affected.
  void Add(const ReceivedEstimate& estimate);
  /// Scores every sample up to and including this index; call it with samples that no estimate still to come can
  /// affect.
  void ScoreThrough(long long index);

  [[nodiscard]] Score Result(Convention convention) const;
  /// Share of the estimates whose 95 % interval held the truth at the end of its pack; NaN without any.
  [[nodiscard]] double Coverage(int parameter) const noexcept;
  [[nodiscard]] std::int64_t num_intervals() const noexcept { return num_intervals_; }

 private:
  struct Pending {
    long long from_index;
    ReceivedEstimate estimate;
  };
  struct Sums {
    double abs_error = 0.0, abs_error_active = 0.0, abs_truth_active = 0.0;
    std::int64_t samples = 0, active = 0;
    double last = 0.0;
  };
  struct View {
    std::deque<Pending> pending;
    ReceivedEstimate shown;
    std::vector<std::vector<Sums>> parameters;
    double target_in_mode = 0.0, target_overall = 0.0, noisy_sq = 0.0, clean_sq = 0.0, truth_sq = 0.0;
    std::int64_t samples = 0, in_mode = 0;
  };
  void ScoreSample(View* view) const;

  const PlantFamily& family_;
  int pack_samples_, stride_;
  double dt_;
  Simulation simulation_;
  std::array<View, 2> views_;
  std::array<std::int64_t, kMaxTruth> covered_{};
  std::int64_t num_intervals_ = 0;
};

}  // namespace armcmc::plant_sim
