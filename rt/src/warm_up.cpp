#include "armcmc/rt/warm_up.hpp"

#include <cmath>
#include <limits>
#include <memory>

#include "armcmc/estimate.hpp"
#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/latest_value.hpp"

namespace armcmc::rt {
namespace {

constexpr int kPacks = 4;
constexpr int kSamples = 100;
constexpr double kDt = 1e-3;
constexpr Nanos kNoDeadline = std::numeric_limits<Nanos>::max();

void FillHuntCrossley(double t, std::size_t n, DataPack* pack) noexcept {
  // Contact throughout: x in [0.7, 1.3] m. K = 4 N/m^p, B = 2.3 N s/m^(p+1), p = 1.7.
  const double x = 1.0 + 0.3 * std::sin(5.0 * t);
  const double v = 1.5 * std::cos(5.0 * t);
  pack->u[n][0] = x;
  pack->u[n][1] = v;
  pack->y[n] = std::pow(x, 1.7) * (4.0 + 2.3 * v);
}

void FillSoftActuator(double t, std::size_t n, DataPack* pack) noexcept {
  // Inflow through a constant gain g: u_c sqrt(p_s - p) = g pdot.
  constexpr double kSupply = 800e3, kAtmosphere = 101'325.0, kGain = 4e-4;
  const double p = kAtmosphere + 1.0 + std::sin(5.0 * t);
  const double pdot = 5.0 * std::cos(5.0 * t);
  pack->u[n][0] = pdot > 0.0 ? kGain * pdot / std::sqrt(kSupply - p) : 0.0;
  pack->u[n][1] = pdot > 0.0 ? 0.0 : -kGain * pdot / std::sqrt(p - kAtmosphere);
  pack->u[n][2] = p;
  pack->u[n][3] = pdot;
  pack->y[n] = 0.42 * (p - kAtmosphere);
}

void FillDescribed(double t, std::size_t n, DataPack* pack) noexcept {
  for (std::size_t i = 0; i < static_cast<std::size_t>(pack->num_inputs); ++i)
    pack->u[n][i] = 1.0 + 0.5 * std::sin((5.0 + static_cast<double>(i)) * t);
  pack->y[n] = 1.0 + 0.5 * std::cos(5.0 * t);
}

}  // namespace

DataPack SyntheticPack(const PackFormat& format, int index) noexcept {
  DataPack pack;
  pack.seq = index + 1;
  pack.run_id = 1;
  pack.dt = kDt;
  pack.plant = format.plant;
  pack.fingerprint = format.fingerprint;
  pack.num_samples = kSamples;
  pack.num_inputs = format.num_inputs;
  for (int n = 0; n < kSamples; ++n) {
    const double t = kDt * (index * kSamples + n);
    const auto row = static_cast<std::size_t>(n);
    switch (format.plant) {
      case PlantKind::kHuntCrossley: FillHuntCrossley(t, row, &pack); break;
      case PlantKind::kSoftActuator: FillSoftActuator(t, row, &pack); break;
      case PlantKind::kDescribed: FillDescribed(t, row, &pack); break;
    }
    pack.t_last_s = t;
  }
  return pack;
}

void WarmUp(StepEngine* engine) noexcept {
  // Static: a megabyte stack need not hold them, and their pages are the process's own.
  static Estimate estimate;
  static DataPack pack;
  for (int i = 0; i < kPacks; ++i) {
    pack = SyntheticPack(engine->pack_format(), i);
    for (int slot = 0; slot < LatestValue::kSlots; ++slot) {
      // No deadline: the draws run to their full number, so that every page of the slot is touched. With the clock, so
      // that the first pack already knows how long the work after its draws takes.
      (void)engine->Adjust(pack, kNoDeadline, MonotonicClock(), slot);
      engine->Execute(slot, &estimate);
    }
  }
  engine->Reset();
}

}  // namespace armcmc::rt
