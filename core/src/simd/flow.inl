// Prediction of the valve flow with effects; included by kernels.inl, once per instruction set.

#include "armcmc/effects/flow_law.hpp"
#include "armcmc/effects/flow_pack.hpp"

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// Where the spool of a slow valve stands at every sample of the pack: spool[n * kLanes + lane].
void MoveSpool(const FlowPack& pack, Simd::V tau, double* spool) noexcept {
  const ValveLag::Spool<Simd> law(tau, pack.dt);
  Simd::V position = Simd::Set(pack.spool);
  for (int n = 0; n < pack.history; ++n)
    position = law.Next(position, Simd::Set(pack.command[static_cast<std::size_t>(n)]));
  for (std::size_t n = 0; n < static_cast<std::size_t>(pack.num_samples); ++n) {
    const Simd::V command = Simd::Set(pack.command[static_cast<std::size_t>(pack.history) + n]);
    position = law.Next(position, command);
    Simd::Store(spool + n * Simd::kLanes, pack.gate[FlowEffects::kIndexOf<ValveLag>][n] != 0.0 ? position : command);
  }
}

void PredictFlow(const ModeData& data, const ThetaTile& theta, PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
  using V = Simd::V;
  using Law = FlowLaw<Simd>;
  const FlowPack& pack = *data.flow;
  const int lag = pack.amplitude[FlowEffects::kIndexOf<ValveLag>];
  alignas(64) double spool[kMaxPackSamples * Simd::kLanes];
  for (int lane = 0; lane < kTileLanes; lane += Simd::kLanes) {
    const auto at = static_cast<std::size_t>(lane);
    const auto row = [&](int parameter) noexcept {
      return Simd::Load(&theta.value[static_cast<std::size_t>(parameter)][at]);
    };
    const V g = row(0);
    const V theta2 = row(1);
    V amplitude[FlowEffects::kSize];
    for (std::size_t e = 0; e < FlowEffects::kSize; ++e)
      amplitude[e] = pack.amplitude[e] >= 0 ? row(pack.amplitude[e]) : V{};
    if (lag >= 0) MoveSpool(pack, row(lag), spool);
    for (std::size_t k = 0; k < static_cast<std::size_t>(data.num_samples); ++k) {
      const auto n = static_cast<std::size_t>(data.sample[k]);
      FlowPoint<Simd> point{lag >= 0 ? Simd::Load(spool + n * Simd::kLanes)
                                     : Simd::Set(pack.command[static_cast<std::size_t>(pack.history) + n]),
                            Simd::Set(pack.gauge[n]), Simd::Set(pack.supply), V{}};
      FlowEffects::ForEach([&]<class E>(std::type_identity<E>, std::size_t e) {
        if constexpr (Law::kActs<E>)
          if (pack.amplitude[e] >= 0) E::template Apply<Simd>(amplitude[e] * Simd::Set(pack.gate[e][n]), &point);
      });
      Simd::Store(&tile->value[k][at],
                  Law::Rate(point, data.mode, g, theta2, Simd::Set(pack.pdot[n]), Simd::Set(pack.least_gain)));
    }
  }
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
