#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

#include "armcmc/data_pack.hpp"
#include "armcmc/settings.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "plants/soft_actuator/model.hpp"

namespace armcmc::test {

inline constexpr int kPackSamples = 100;
inline constexpr double kSampleInterval = 1e-3;  // s

/// A pack of a plant whose samples are all zero.
inline DataPack BlankPack(PlantNumber plant, std::int64_t seq, int num_samples = kPackSamples,
                          double dt = kSampleInterval) {
  DataPack pack;
  pack.seq = seq;
  pack.run_id = 1;
  pack.dt = dt;
  pack.plant = plant;
  pack.num_samples = num_samples;
  pack.num_inputs = plant == HuntCrossley::kInfo.plant ? 2 : 4;
  return pack;
}

/// Parameters of a contact, and the force that they make.
struct ContactTruth {
  double k = 4.0, b = 2.3, p = 1.7;
  [[nodiscard]] double Force(double x, double v) const { return x >= 0.0 ? std::pow(x, p) * (k + b * v) : 0.0; }
};

/// Depth of a contact, m, and its rate, m/s.
struct Place {
  double x = 0.0, v = 0.0;
};

/// Pack `seq` of a contact that is at `place_at(t)` at time t, s, where its sensor says `measured(t, place)`.
template <class PlaceAt, class Measured>
DataPack FillContactPack(std::int64_t seq, const PlaceAt& place_at, const Measured& measured,
                         int num_samples = kPackSamples, double dt = kSampleInterval) {
  DataPack pack = BlankPack(HuntCrossley::kInfo.plant, seq, num_samples, dt);
  for (int n = 0; n < num_samples; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const double t = static_cast<double>((seq - 1) * num_samples + n) * dt;
    const Place place = place_at(t);
    pack.u[i] = {place.x, place.v};
    pack.y[i] = measured(t, place);
    pack.t_last_s = t;
  }
  pack.t_last_ns = static_cast<Nanos>(pack.t_last_s * 1e9);
  return pack;
}

/// The paper's sliding contact. Pack k holds samples 100k-99 .. 100k; in contact from 0.05 s to 4.30 s and from 6.33 s
/// to 10.58 s. Every pack has noise of its own, whichever packs were made before it.
struct Contact {
  double k = 4.0, b = 2.3, p = 1.7;
  double noise_std = 0.1;
  std::uint64_t seed = 1;

  static Place At(double t) { return {0.6 + 1.14 * std::sin(t - 0.6), 1.14 * std::cos(t - 0.6)}; }
  [[nodiscard]] DataPack Pack(std::int64_t seq) const {
    std::mt19937_64 generator(seed * 1'000'003 + static_cast<std::uint64_t>(seq));
    std::normal_distribution<double> noise(0.0, noise_std);
    const ContactTruth truth{k, b, p};
    return FillContactPack(seq, &Contact::At,
                           [&](double, const Place& at) { return truth.Force(at.x, at.v) + noise(generator); });
  }
};
inline constexpr std::int64_t kFreePack = 55;       ///< Of Contact: no sample in contact.
inline constexpr std::int64_t kSecondContact = 64;  ///< The pack in which contact returns.

/// Normal numbers that do not depend on the standard library: Box-Muller on mt19937_64. One stream for all packs of a
/// run.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : engine_(seed) {}
  double Uniform() { return (static_cast<double>(engine_() >> 11) + 0.5) * 0x1p-53; }
  double operator()() { return std::sqrt(-2.0 * std::log(Uniform())) * std::cos(6.283185307179586 * Uniform()); }

 private:
  std::mt19937_64 engine_;
};

/// x(t) = depth + swing sin(2 pi hertz t + phase).
struct Motion {
  double depth = 1.0, swing = 0.5, hertz = 10.0, phase = 0.0;
  [[nodiscard]] Place At(double t) const {
    const double omega = 6.283185307179586 * hertz;
    return {depth + swing * std::sin(omega * t + phase), swing * omega * std::cos(omega * t + phase)};
  }
};

inline DataPack MakeContactPack(std::int64_t seq, const Motion& motion, const ContactTruth& truth, double noise_std,
                                Normal* normal, int num_samples = kPackSamples, double dt = kSampleInterval) {
  return FillContactPack(
      seq, [&](double t) { return motion.At(t); },
      [&](double, const Place& at) { return truth.Force(at.x, at.v) + noise_std * (*normal)(); }, num_samples, dt);
}

/// The excited actuator: pressure swings over tens of kPa; mode 0 (u_c) in the first `filling` samples, then mode 1.
struct Actuator {
  double p_atm = ActuatorConstants{}.p_atm;
  std::array<double, 2> gain{-2.14e-4 + 6.12e-9 * p_atm, -9.76e-5 - 1.9e-9 * p_atm};
  std::array<double, 2> slope{6.12e-9, -1.9e-9};
  double noise_std = 0.1;  ///< Of the valve flow, sqrt(Pa).
  std::uint64_t seed = 1;

  [[nodiscard]] DataPack Pack(std::int64_t seq, int filling) const {
    DataPack pack = BlankPack(SoftActuator::kInfo.plant, seq);
    std::mt19937_64 generator(seed * 1'000'003 + static_cast<std::uint64_t>(seq));
    std::normal_distribution<double> noise(0.0, noise_std);
    const ActuatorConstants constants;
    for (std::size_t n = 0; n < kPackSamples; ++n) {
      const double t = kSampleInterval * (static_cast<double>(seq * kPackSamples) + static_cast<double>(n));
      const double p = p_atm + 40e3 + 30e3 * std::sin(40.0 * t);
      const double p_rate = 1.2e6 * std::cos(40.0 * t);
      const std::size_t m = static_cast<int>(n) < filling ? 0 : 1;
      const double head = std::sqrt(m == 0 ? constants.p_supply - p : p - p_atm);
      const double u = (p_rate * (gain[m] + slope[m] * (p - p_atm)) + noise(generator)) / head;
      pack.u[n] = {m == 0 ? u : 0.0, m == 1 ? u : 0.0, p, p_rate};
      pack.y[n] = 0.02;
      pack.t_last_s = t;
    }
    return pack;
  }
};

}  // namespace armcmc::test
