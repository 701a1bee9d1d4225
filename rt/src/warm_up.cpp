#include "armcmc/rt/warm_up.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "armcmc/estimate.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/latest_value.hpp"

namespace armcmc::rt {
namespace {

constexpr int kPacks = 4;
constexpr int kUsualSamples = 100;
constexpr double kDt = 1e-3;
constexpr Nanos kNoDeadline = std::numeric_limits<Nanos>::max();

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
  const int samples = format.overlap * std::max(1, kUsualSamples / format.overlap);
  pack.num_samples = samples;
  pack.num_inputs = format.num_inputs;
  const ModelInfo* model = ModelOf(format.plant);
  for (int n = 0; n < samples; ++n) {
    const double t = kDt * (index * samples + n);
    const auto row = static_cast<std::size_t>(n);
    if (model != nullptr) {
      model->compiled->typical_sample(t, row, &pack);
    } else {
      FillDescribed(t, row, &pack);
    }
    pack.t_last_s = t;
  }
  return pack;
}

void WarmUp(StepEngine* engine) noexcept {
  // Static: a megabyte stack need not hold them, and their pages are the process's own.
  static Estimate estimate;
  static DataPack pack;
  // Where packs overlap every recursion gets one, three times.
  const int packs = std::max(kPacks, engine->pack_format().overlap);
  for (int i = 0; i < packs; ++i) {
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
