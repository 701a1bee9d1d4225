// The valve flow with effects; included by plants/kernels.inl, once per instruction set.

#include "plants/soft_actuator/flow_law.hpp"
#include "plants/soft_actuator/flow_pack.hpp"

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

double Command(const FlowPack& pack, std::size_t n) noexcept {
  return pack.command[static_cast<std::size_t>(pack.history) + n];
}

const FlowPack& FlowOf(const ModeData& data) noexcept { return static_cast<const FlowPack&>(*data.compiled); }

/// Where the spool of a slow valve stands at every sample of the pack: spool[n * kLanes + lane].
void MoveSpool(const FlowPack& pack, Simd::V tau, double* spool) noexcept {
  const ValveLag::Spool<Simd> law(tau, pack.dt);
  Simd::V position = Simd::Set(pack.spool);
  for (int n = 0; n < pack.history; ++n)
    position = law.Next(position, Simd::Set(pack.command[static_cast<std::size_t>(n)]));
  for (std::size_t n = 0; n < static_cast<std::size_t>(pack.num_samples); ++n) {
    const Simd::V command = Simd::Set(Command(pack, n));
    position = law.Next(position, command);
    Simd::Store(spool + n * Simd::kLanes, pack.gate[FlowEffects::kIndexOf<ValveLag>][n] != 0.0 ? position : command);
  }
}

/// A mode's parameters as the flow reads them: g, theta2, then an amplitude for each effect, 0 where it is not there.
constexpr std::size_t kFlowRows = 2 + FlowEffects::kSize;

Simd::V FlowRow(const FlowPack& pack, const ThetaTile& theta, std::size_t row, std::size_t at) noexcept {
  const int parameter = row < 2 ? static_cast<int>(row) : pack.amplitude[row - 2];
  return parameter < 0 ? Simd::V{} : Simd::Load(&theta.value[static_cast<std::size_t>(parameter)][at]);
}

/// Pressure rate at sample n of the pack, for an opening that a slow valve may have changed.
[[gnu::always_inline]] inline Simd::V FlowRate(const FlowPack& pack, int mode, const Simd::V* theta, Simd::V opening,
                                               std::size_t n) noexcept {
  using Law = FlowLaw<Simd>;
  FlowPoint<Simd> point{opening, Simd::Set(pack.gauge[n]), Simd::Set(pack.supply), Simd::V{}};
  FlowEffects::ForEach([&]<class E>(std::type_identity<E>, std::size_t e) {
    if constexpr (Law::kActs<E>)
      if (pack.amplitude[e] >= 0) E::template Apply<Simd>(theta[2 + e] * Simd::Set(pack.gate[e][n]), &point);
  });
  const Simd::V head = pack.head_moves ? Law::Head(point, mode) : Simd::Set(pack.head[n]);
  return Law::Rate(point, mode, head, theta[0], theta[1], Simd::Set(pack.pdot[n]), Simd::Set(pack.least_gain));
}

/// Every sample depends on its own command only.
bool ValvesAreFast(const FlowPack& pack) noexcept { return pack.amplitude[FlowEffects::kIndexOf<ValveLag>] < 0; }

void PredictFlow(const ModeData& data, const ThetaTile& theta, int lanes,
                 PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
  const FlowPack& pack = FlowOf(data);
  const bool fast = ValvesAreFast(pack);
  alignas(64) double spool[kMaxPackSamples * Simd::kLanes];
  for (int lane = 0; lane < lanes; lane += Simd::kLanes) {
    const auto at = static_cast<std::size_t>(lane);
    Simd::V row[kFlowRows];
    for (std::size_t r = 0; r < kFlowRows; ++r) row[r] = FlowRow(pack, theta, r, at);
    if (!fast) MoveSpool(pack, row[2 + FlowEffects::kIndexOf<ValveLag>], spool);
    for (std::size_t k = 0; k < static_cast<std::size_t>(data.num_samples); ++k) {
      const auto n = static_cast<std::size_t>(data.sample[k]);
      const Simd::V opening = fast ? Simd::Set(Command(pack, n)) : Simd::Load(spool + n * Simd::kLanes);
      Simd::Store(&tile->value[k][at], FlowRate(pack, data.mode, row, opening, n));
    }
  }
}

/// The valve flow with effects, but for slow valves.
struct FlowForward {
  static constexpr unsigned kRows = kFlowRows;
  const ModeData& data;
  static bool Far(int) noexcept { return false; }
  template <class S>
  Simd::V AddTo(Simd::V base, const Simd::V* theta, int k) const noexcept {
    const auto n = static_cast<std::size_t>(data.sample[static_cast<unsigned>(k)]);
    return base + FlowRate(FlowOf(data), data.mode, theta, Simd::Set(Command(FlowOf(data), n)), n);
  }
  Simd::V Load(const ThetaTile& theta, unsigned i, unsigned lane) const noexcept {
    return FlowRow(FlowOf(data), theta, i, lane);
  }
};

void SumSquaresFlow(const ModeData& data, const ThetaTile& theta, double noise_mean,
                    double* out) noexcept ARMCMC_NONBLOCKING {
  SumSquaresOf(FlowForward{data}, data, theta, noise_mean, out);
}

template <>
struct PlantKernels<SoftActuator> {
  static void Predict(const ModeData& data, const ThetaTile& theta, int lanes,
                      PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
    PredictFlow(data, theta, lanes, tile);
  }
  static SumSquaresFn Squares(const ModeData& data) noexcept ARMCMC_NONBLOCKING {
    return ValvesAreFast(FlowOf(data)) ? &SumSquaresFlow : nullptr;
  }
};

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
