#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "armcmc/settings.hpp"
#include "plants/soft_actuator/effect_sizes.hpp"
#include "plants/soft_actuator/model.hpp"
#include "support/packs.hpp"

namespace armcmc::test {

/// A recording of the actuator whose valves work between levels of pressure, simulated in plain scalar code that shares
/// nothing with the library: what is measured, and the opening that was really there.
struct ValveSeries {
  double dt = 1e-3, p_atm = 101'325.0, p_supply = 800e3;
  std::array<double, 2> g{4.06e-4, -2.9e-4}, theta2{6.12e-9, -1.9e-9};
  double leak = 0.0, width = 0.0, tau = 0.0, droop = 0.0, bias = 0.0;
  double from_s = -std::numeric_limits<double>::infinity();  ///< When the effects begin.
  double rate_noise = 500.0;                                 ///< Pa/s
  unsigned seed = 1;

  std::vector<double> t, u_c, u_d, p, pdot, clean_pdot, opening;

  void Simulate(int samples) {
    constexpr std::array<double, 8> kLevels{60e3, 25e3, 80e3, 45e3, 70e3, 15e3, 50e3, 30e3};
    constexpr int kDwell = 250, kSteps = 20;
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> noise(0.0, rate_noise);
    double gauge = 0.0, spool = 0.0;
    for (int n = 0; n < samples; ++n) {
      const double now = n * dt;
      const bool on = now >= from_s;
      const double level = kLevels[static_cast<std::size_t>(n / kDwell) % kLevels.size()];
      const double wanted = std::clamp(1e-5 * (level - gauge), -0.1, 0.1);
      spool = tau > 0.0 ? std::exp(-dt / tau) * spool + (1.0 - std::exp(-dt / tau)) * wanted : wanted;
      double open = on ? spool : wanted;
      if (on && width > 0.0) {
        const double beyond = std::max(std::abs(open) - width, 0.0) / (1.0 - width);
        open = open < 0.0 ? -beyond : beyond;
      }
      const auto rate = [&](double at) {
        const std::size_t m = open < 0.0 ? 1 : 0;
        const double supply = p_supply - (on && open > 0.0 ? droop * open : 0.0);
        const double dp = m == 0 ? supply - p_atm - at : at;
        const double head = dp < 0.0 ? -std::sqrt(-dp) : std::sqrt(dp);
        return std::abs(open) * head / (g[m] + theta2[m] * at) - (on ? leak * at : 0.0);
      };
      t.push_back(now);
      u_c.push_back(std::max(wanted, 0.0));
      u_d.push_back(std::max(-wanted, 0.0));
      p.push_back(p_atm + gauge + (on ? bias : 0.0));
      clean_pdot.push_back(rate(gauge));
      pdot.push_back(clean_pdot.back() + noise(generator));
      opening.push_back(open);
      for (int i = 0; i < kSteps; ++i) {
        const double h = dt / kSteps;
        gauge += h * rate(gauge + 0.5 * h * rate(gauge));
      }
    }
  }

  /// Samples [first, first + count) as pack number seq.
  [[nodiscard]] DataPack Pack(std::int64_t seq, std::size_t first, std::size_t count) const {
    DataPack pack = BlankPack(SoftActuator::kInfo.plant, seq, static_cast<int>(count), dt);
    for (std::size_t n = 0; n < count; ++n) pack.u[n] = {u_c[first + n], u_d[first + n], p[first + n], pdot[first + n]};
    pack.t_last_s = t[first + count - 1];
    pack.t_last_ns = static_cast<Nanos>(pack.t_last_s * 1e9);
    return pack;
  }
  [[nodiscard]] std::vector<DataPack> Packs() const {
    std::vector<DataPack> packs;
    for (std::size_t first = 0; first + 100 <= t.size(); first += 100)
      packs.push_back(Pack(static_cast<std::int64_t>(first / 100) + 1, first, 100));
    return packs;
  }
};

/// An effect of the valve flow at a value that shows.
struct FlowCase {
  std::string name;
  double ValveSeries::*value;
  double truth;
  std::vector<std::size_t> modes;  ///< Valves that feel it.
};

inline std::vector<FlowCase> FlowCases() {
  return {{"pressure_bias", &ValveSeries::bias, -6e3, {1}},
          {"valve_lag", &ValveSeries::tau, 0.004, {0, 1}},
          {"valve_dead_band", &ValveSeries::width, 0.006, {0, 1}},
          {"supply_droop", &ValveSeries::droop, 1.5e6, {0}},
          {"leak", &ValveSeries::leak, 0.05, {0, 1}}};
}

inline ValveSeries Measured(const std::vector<FlowCase>& cases, int samples, unsigned seed = 1) {
  ValveSeries series;
  for (const FlowCase& one : cases) series.*one.value = one.truth;
  series.seed = seed;
  series.Simulate(samples);
  return series;
}

/// The excited actuator with effects under the catalogue's priors for signals of its size.
inline EstimatorSettings WithFlowEffects(const std::vector<FlowCase>& cases) {
  EstimatorSettings settings = BuiltinSettings("soft_actuator_excited");
  for (NoiseSettings& noise : settings.noise) noise.std = 500.0;
  for (const FlowCase& one : cases)
    settings.effects[static_cast<std::size_t>(settings.num_effects++)] =
        MakeEffect(SoftActuator::kInfo, one.name,
                   ActuatorScales{.pressure = 5e4, .pressure_rate = 3e4, .opening = 0.03, .supply = 7e5});
  return settings;
}

}  // namespace armcmc::test
