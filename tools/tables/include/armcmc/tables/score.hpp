#pragma once

#include <array>

#include "armcmc/settings.hpp"
#include "armcmc/tables/recording.hpp"
#include "armcmc/tables/trace.hpp"

namespace armcmc::tables {

/// Which point estimate is scored.
enum class Point { kMap, kAp };

/// What a method learns about drift, means over the packs that hold data of a mode.
struct DriftScore {
  double share = 0.0;            ///< Probability that the parameters drift.
  std::array<double, 3> rate{};  ///< Expected speed, unit of the parameter per s.
};

struct ContactScore {
  std::array<double, 3> mae_contact{};         ///< Of K, B, p in contact; an estimate counts as 0 until there is one.
  std::array<double, 3> mae_active_contact{};  ///< In contact while an estimate is shown.
  double force_contact_mn = 0.0, force_overall_mn = 0.0;  ///< MAE of the force against the true one.
  double noisy_force_l2_n = 0.0;  ///< Root of the sum of squares against the measured force: what the paper prints.
  /// Share of the packs in contact with an estimate whose interval, after the pack, holds the truth at its last sample.
  std::array<std::array<double, 3>, 3> coverage{};           ///< [level][parameter]
  std::array<std::array<double, 3>, 3> width{};              ///< Mean width of those intervals.
  std::array<std::array<double, 3>, 3> coverage_variance{};  ///< Of coverage, if the intervals are right.
  int false_modifications = 0;                               ///< Decisions "modification" after the first pack.
  DriftScore drift;
  double median_ms = 0.0, max_ms = 0.0, mean_draws = 0.0;
};
[[nodiscard]] ContactScore ScoreContact(const Recording& recording, const Trace& trace, Point point,
                                        const EstimatorSettings& settings);

/// Force shown for every sample, with the prior's mean before the first estimate.
[[nodiscard]] std::vector<double> ShownForce(const Recording& recording, const Trace& trace, Point point,
                                             const EstimatorSettings& settings);

struct ActuatorScore {
  std::array<double, 2> g_rel_error{};      ///< Mean |g_hat / g - 1| of u_c, u_d while shown.
  double theta1_l2 = 0.0, theta2_l2 = 0.0;  ///< Root of the sum of squares over the samples while shown.
  double alpha_l2 = 0.0;                    ///< Angle from the valve inputs alone since the start, rad.
  double alpha_restarted_l2 = 0.0;          ///< Angle restarted from the measured pressure at each pack, rad.
  double flow_rel_error = 0.0;  ///< ||pdot (g + theta2 (p - p_atm)) - flow|| / ||flow||; nothing shown: flow 0.
  std::array<std::array<double, 2>, 2> coverage50{}, coverage95{};  ///< [mode][g, theta2]
  std::array<DriftScore, 2> drift;                                  ///< By mode: of g, theta2.
  double median_ms = 0.0, max_ms = 0.0;
};
[[nodiscard]] ActuatorScore ScoreActuator(const Recording& recording, const Trace& trace, Point point,
                                          const EstimatorSettings& settings);

/// The angle from the valve inputs alone since the start, with the estimates on display.
[[nodiscard]] std::vector<double> ShownAngle(const Recording& recording, const Trace& trace, Point point,
                                             const EstimatorSettings& settings, bool restarted);

}  // namespace armcmc::tables
