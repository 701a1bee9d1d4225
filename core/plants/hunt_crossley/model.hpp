#pragma once

#include <cmath>

#include "armcmc/model.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// What the engine asks of this plant.
extern const CompiledPlant kContactPlant;

/// Hunt-Crossley contact force (equation `huntt`):
///
///   f = x^p (K + B v)  for x >= 0,  0 otherwise,      theta = (K, B, p)
///
/// x penetration m, v its rate m/s, f N; K N/m^p, B N s/m^(p+1), p dimensionless.
/// Mode 0 is contact; free motion carries no information on theta and is the passive mode.
struct HuntCrossley {
  static int ModeOf(const DataPack& pack, int n) noexcept ARMCMC_NONBLOCKING {
    return pack.u[static_cast<std::size_t>(n)][0] >= 0.0 ? 0 : 1;
  }

  static constexpr ModelInfo kInfo{
      .name = "hunt_crossley",
      .plant = PlantNumber{1},
      .target_unit = "N",
      .num_parameters = 3,
      .parameters = {{{"K", "N/m^p", 2.5, 2.0, 0.0, 8.0},
                      {"B", "N s/m^(p+1)", 2.5, 2.0, 0.0, 8.0},
                      {"p", "-", 1.5, 0.35, 1.0, 2.5}}},
      .num_modes = 1,
      .modes = {"contact", "free"},
      .num_inputs = 2,
      .default_noise_std = 0.1,
      .num_reported = 3,
      .reported = {{{"K", "N/m^p"}, {"B", "N s/m^(p+1)"}, {"p", "-"}}},
      .mode_of = &ModeOf,
      .report = nullptr,
      .compiled = &kContactPlant,
      .linear = {{{.linear = {0, 1}, .num_linear = 2, .curved = 2}}},
  };

  /// Features: 0 log2 x (x^p = 2^(p log2 x), so that one exp2 is all a candidate costs), 1 v.
  static void Prepare(const DataPack& pack, const PlantConstants&, int mode,
                      ModeData* data) noexcept ARMCMC_NONBLOCKING {
    constexpr double kLog2OfZero = -1000.0;  // x = 0: x^p underflows to 0 for every p >= 1
    int m = 0;
    for (int n = 0; n < pack.num_samples; ++n) {
      if (ModeOf(pack, n) != mode) continue;
      const auto in = static_cast<std::size_t>(n);
      const auto im = static_cast<std::size_t>(m++);
      const double x = pack.u[in][0];
      data->feature[0][im] = x > 0.0 ? std::fmax(std::log2(x), kLog2OfZero) : kLog2OfZero;
      data->feature[1][im] = pack.u[in][1];
      data->target[im] = pack.y[in];
      data->sample[im] = static_cast<std::int16_t>(n);
    }
    data->num_samples = m;
  }

  template <class S>
  static typename S::V Predict(const typename S::V* theta, const ModeData& data, int n) noexcept {
    const auto in = static_cast<std::size_t>(n);
    return Law<S>(theta[0], theta[1], theta[2], S::Set(data.feature[0][in]), S::Set(data.feature[1][in]));
  }

  /// The constitutive law for log2 of the depth and its rate.
  template <class S>
  static typename S::V Law(typename S::V stiffness, typename S::V damping, typename S::V exponent, typename S::V log2_x,
                           typename S::V v) noexcept {
    const auto power = S::Exp2(exponent * log2_x);
    return power * S::Fma(damping, v, stiffness);
  }

  static constexpr int kExponent = 2;  ///< Parameter that is the exponent of the law's only power.
  /// log2 of the base of that power at sample n.
  static double Log2(const ModeData& data, int n) noexcept { return data.feature[0][static_cast<std::size_t>(n)]; }

  /// Largest |log2| of a base that S::Power is asked for at sample n.
  static double LargestLog2(const ModeData& data, int n) noexcept {
    return std::fabs(data.feature[0][static_cast<std::size_t>(n)]);
  }

  /// base + Predict, as the scoring loop asks for it: S::Power need not be exact to the last bits.
  template <class S>
  static typename S::V AddTo(typename S::V base, const typename S::V* theta, const ModeData& data, int n) noexcept {
    const auto in = static_cast<std::size_t>(n);
    return AddLaw<S>(base, theta[0], theta[1], theta[2], data.feature[0][in], data.feature[1][in]);
  }

  /// AddTo() where the power is known.
  template <class S>
  static typename S::V AddPower(typename S::V base, typename S::V power, const typename S::V* theta,
                                const ModeData& data, int n) noexcept {
    const auto in = static_cast<std::size_t>(n);
    return S::Fma(power, S::Fma(theta[1], S::Set(data.feature[1][in]), theta[0]), base);
  }

  template <class S>
  static typename S::V AddLaw(typename S::V base, typename S::V stiffness, typename S::V damping,
                              typename S::V exponent, double log2_x, double v) noexcept {
    return S::Fma(S::Power(exponent, log2_x), S::Fma(damping, S::Set(v), stiffness), base);
  }
};

}  // namespace armcmc
