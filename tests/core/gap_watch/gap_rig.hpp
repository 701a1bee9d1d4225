#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>

#include "armcmc/gap_watch/gap_watch.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/settings.hpp"
#include "simd/kernels.hpp"
#include "support/packs.hpp"

namespace armcmc::test {

/// One sample of the sliding contact before noise.
struct ContactSample {
  double t, x, v, a;
};
using ForceLaw = std::function<double(const ContactSample&)>;
using NoiseLaw = std::function<double(const ContactSample&)>;

inline double BaseForce(double x, double v, double k = 4.0, double b = 2.3, double p = 1.7) {
  return ContactTruth{k, b, p}.Force(x, v);
}

inline ContactSample SampleAt(double t) {
  const Place place = Contact::At(t);
  return {t, place.x, place.v, -1.14 * std::sin(t - 0.6)};
}

/// Noise of standard deviation 0.1 N, each law with a stream of its own.
inline NoiseLaw MakeNoise(const std::string& law, std::uint64_t seed) {
  auto generator = std::make_shared<std::mt19937_64>(seed * 7919 + 13);
  auto normal = std::make_shared<std::normal_distribution<double>>(0.0, 1.0);
  if (law == "student") {
    auto student = std::make_shared<std::student_t_distribution<double>>(4.0);
    return [=](const ContactSample&) { return 0.1 / std::sqrt(2.0) * (*student)(*generator); };
  }
  if (law == "ar") {
    auto state = std::make_shared<double>(0.0);
    return [=](const ContactSample&) { return *state = 0.8 * *state + 0.06 * (*normal)(*generator); };
  }
  if (law == "uneven")
    return [=](const ContactSample& s) {
      return (s.v > 0.0 ? 0.2 : 0.05) * (1.0 + std::fabs(s.x)) * (*normal)(*generator);
    };
  return [=](const ContactSample&) { return 0.1 * (*normal)(*generator); };
}

/// The watch alone, told the parameters of the plant (a little wrong) instead of estimates.
class GapRig {
 public:
  explicit GapRig(double tolerance = GapWatchSettings{}.tolerance)
      : settings_(BuiltinSettings("hunt_crossley")),
        watch_(Prepared(tolerance, &settings_), 0, simd::Best(), settings_.gap_watch.false_alarm_rate) {
    told.known[0] = true;
    told.theta[0] = {4.05, 2.27, 1.705};
    told.noise_std[0] = 0.1;
  }

  DataPack Pack(std::int64_t seq, const ForceLaw& force, const NoiseLaw& noise) const {
    const auto measured = [&](double t, const Place&) {
      const ContactSample s = SampleAt(t);
      return force(s) + noise(s);
    };
    DataPack pack = FillContactPack(seq, &Contact::At, measured, samples);
    pack.run_id = run_id;
    return pack;
  }

  /// @return time of the alarm, s; 0: none.
  double Run(double seconds, const ForceLaw& force, const NoiseLaw& noise,
             const std::function<void(const GapState&)>& on_step = {},
             const std::function<bool(double)>& changed = {}) {
    const double period = 1e-3 * samples;
    for (std::int64_t seq = 1; period * static_cast<double>(seq) < seconds; ++seq) {
      const DataPack pack = Pack(seq, force, noise);
      watch_.Step(pack, told, changed && changed(pack.t_last_s), drifts);
      if (on_step) on_step(watch_.state());
    }
    return period * static_cast<double>(watch_.state().alarm_seq);
  }

  [[nodiscard]] GapWatch& watch() { return watch_; }
  GapReference told;
  bool drifts = false;  ///< What it is told.
  int samples = 100;
  std::int64_t run_id = 1;

 private:
  static const EstimatorSettings& Prepared(double tolerance, EstimatorSettings* settings) {
    settings->gap_watch.tolerance = tolerance;
    return *settings;
  }
  EstimatorSettings settings_;
  GapWatch watch_;
};

inline double TruthAlone(const ContactSample& s) { return BaseForce(s.x, s.v); }

}  // namespace armcmc::test
