#pragma once

#include <cmath>

#include "armcmc/model.hpp"
#include "armcmc/nonblocking.hpp"
#include "plants/soft_actuator/constants.hpp"

namespace armcmc {

/// What the engine asks of this plant.
extern const CompiledPlant kActuatorPlant;

/// Valve flow of the fluid soft bending actuator (equation `dyn_2nd2`), in the gain form
///
///   u sign(dp) sqrt|dp| = pdot (g + theta2 (p - p_atm)),      theta = (g, theta2),  theta1 = g - theta2 p_atm
///
/// Mode 0: u = u_c, dp = p_supply - p.  Mode 1: u = u_d, dp = p - p_atm. Both valves shut is the passive mode.
/// p Pa, pdot Pa/s. g is the gain at atmospheric pressure: theta1 and theta2 p_atm are nearly equal and opposite,
/// so that the paper's pair (theta1, theta2) is almost perfectly correlated and g is not.
struct SoftActuator {
  static int ModeOf(const DataPack& pack, int n) noexcept ARMCMC_NONBLOCKING {
    const auto& u = pack.u[static_cast<std::size_t>(n)];
    if (u[0] != 0.0) return 0;
    return u[1] != 0.0 ? 1 : 2;
  }

  static void Report(const double* theta, const PlantConstants& constants,
                     double* reported) noexcept ARMCMC_NONBLOCKING {
    reported[0] = theta[0];
    reported[1] = theta[1];
    reported[2] = theta[0] - theta[1] * ActuatorConstants(constants).p_atm;
  }

  static constexpr ModelInfo kInfo{
      .name = "soft_actuator",
      .plant = PlantNumber{2},
      .target_unit = "sqrt(Pa)",
      .num_parameters = 2,
      .parameters = {{{"g", "sqrt(Pa) s/Pa", 0.0, 1e-3, -5e-3, 5e-3},
                      {"theta2", "sqrt(Pa) s/Pa^2", 0.0, 1e-8, -5e-8, 5e-8}}},
      .num_modes = 2,
      .modes = {"u_c", "u_d", "shut"},
      .num_inputs = 4,
      .default_noise_std = 1e-6,
      .num_reported = 3,
      .reported = {{{"g", "sqrt(Pa) s/Pa"}, {"theta2", "sqrt(Pa) s/Pa^2"}, {"theta1", "sqrt(Pa) s/Pa"}}},
      .mode_of = &ModeOf,
      .report = &Report,
      .compiled = &kActuatorPlant,
      .linear = {{{.linear = {0, 1}, .num_linear = 2}, {.linear = {0, 1}, .num_linear = 2}}},
  };

  /// sign(dp) sqrt|dp| of the valve that mode opens; sqrt(Pa).
  static double Head(double p, int mode, const ActuatorConstants& constants) noexcept {
    const double dp = mode == 0 ? constants.p_supply - p : p - constants.p_atm;
    return std::copysign(std::sqrt(std::fabs(dp)), dp);
  }

  /// Features: 0 pdot, 1 pdot (p - p_atm).
  static void Prepare(const DataPack& pack, const PlantConstants& values, int mode,
                      ModeData* data) noexcept ARMCMC_NONBLOCKING {
    const ActuatorConstants constants(values);
    int m = 0;
    for (int n = 0; n < pack.num_samples; ++n) {
      if (ModeOf(pack, n) != mode) continue;
      const auto& u = pack.u[static_cast<std::size_t>(n)];
      const auto im = static_cast<std::size_t>(m++);
      data->target[im] = u[static_cast<std::size_t>(mode)] * Head(u[2], mode, constants);
      data->sample[im] = static_cast<std::int16_t>(n);
      data->feature[0][im] = u[3];
      data->feature[1][im] = u[3] * (u[2] - constants.p_atm);
    }
    data->num_samples = m;
  }

  template <class S>
  static typename S::V Predict(const typename S::V* theta, const ModeData& data, int n) noexcept {
    const auto in = static_cast<std::size_t>(n);
    return S::Fma(theta[1], S::Set(data.feature[1][in]), theta[0] * S::Set(data.feature[0][in]));
  }

  static constexpr int kExponent = -1;  ///< No parameter is an exponent.
  static double LargestLog2(const ModeData&, int) noexcept { return 0.0; }

  /// base + Predict: what the scoring loop asks for.
  template <class S>
  static typename S::V AddTo(typename S::V base, const typename S::V* theta, const ModeData& data, int n) noexcept {
    const auto in = static_cast<std::size_t>(n);
    return S::Fma(theta[1], S::Set(data.feature[1][in]), S::Fma(theta[0], S::Set(data.feature[0][in]), base));
  }
};

}  // namespace armcmc
