// The contact with effects; included by plants/kernels.inl, once per instruction set.

#include <iterator>

#include "plants/hunt_crossley/contact_pack.hpp"
#include "plants/hunt_crossley/effects.hpp"

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// Additive effects: one FMA each a sample, their number known to the compiler.
template <std::size_t kAdditive>
void PredictAdditive(const ContactPack& pack, const ThetaTile& theta, int lanes,
                     PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
  for (int lane = 0; lane < lanes; lane += Simd::kLanes) {
    const auto at = static_cast<std::size_t>(lane);
    const V stiffness = Simd::Load(&theta.value[0][at]);
    const V damping = Simd::Load(&theta.value[1][at]);
    const V exponent = Simd::Load(&theta.value[2][at]);
    V amplitude[kAdditive];
    for (std::size_t a = 0; a < kAdditive; ++a)
      amplitude[a] = Simd::Load(&theta.value[static_cast<std::size_t>(pack.additive_amplitude[a])][at]);
    for (std::size_t n = 0; n < static_cast<std::size_t>(pack.num_samples); ++n) {
      V f = HuntCrossley::Law<Simd>(stiffness, damping, exponent, Simd::Set(pack.log2_x[n]), Simd::Set(pack.v[n]));
      for (std::size_t a = 0; a < kAdditive; ++a) f = Simd::Fma(amplitude[a], Simd::Set(pack.feature[a][n]), f);
      Simd::Store(&tile->value[n][at], f);
    }
  }
}

/// Where a gate is shut the series stays as it is.
Simd::V Gated(double gate, Simd::V yes, Simd::V no) noexcept { return gate != 0.0 ? yes : no; }

/// Plant forces of one vector of candidates, history included: input map, constitutive law, additive terms.
void PlantForces(const ContactPack& pack, const ThetaTile& theta, std::size_t at, double* series) noexcept {
  const auto amplitude_of = [&](int parameter) noexcept {
    return parameter < 0 ? V{} : Simd::Load(&theta.value[static_cast<std::size_t>(parameter)][at]);
  };
  const V stiffness = amplitude_of(0);
  const V damping = amplitude_of(1);
  const V exponent = amplitude_of(2);
  const V offset = amplitude_of(pack.contact_offset);
  const V rate = amplitude_of(pack.stiffness_rate);
  V amplitude[kMaxAdditive];
  for (int a = 0; a < pack.num_additive; ++a)
    amplitude[a] = amplitude_of(pack.additive_amplitude[static_cast<std::size_t>(a)]);
  for (std::size_t n = 0; n < static_cast<std::size_t>(pack.rows()); ++n) {
    const V log2_x = pack.contact_offset < 0 ? Simd::Set(pack.log2_x[n])
                                             : ContactOffset::Log2Depth<Simd>(Simd::Set(pack.x[n]), offset,
                                                                              Simd::Set(pack.contact_offset_gate[n]));
    const V k = pack.stiffness_rate < 0 ? stiffness
                                        : StiffnessDrift::Stiffness<Simd>(stiffness, rate, Simd::Set(pack.elapsed[n]));
    V f = HuntCrossley::Law<Simd>(k, damping, exponent, log2_x, Simd::Set(pack.v[n]));
    for (std::size_t a = 0; a < static_cast<std::size_t>(pack.num_additive); ++a)
      f = Simd::Fma(amplitude[a], Simd::Set(pack.feature[a][n]), f);
    Simd::Store(series + n * Simd::kLanes, f);
  }
}

/// What the sensor makes of them, in place: delay, low pass, limit.
void Sense(const ContactPack& pack, const ThetaTile& theta, std::size_t at, double* series) noexcept {
  const int rows = pack.rows();
  const auto amplitude_of = [&](int parameter) noexcept {
    return Simd::Load(&theta.value[static_cast<std::size_t>(parameter)][at]);
  };
  const auto force = [&](int n) noexcept { return series + static_cast<std::size_t>(n) * Simd::kLanes; };
  if (pack.delay >= 0) {
    const V lag = amplitude_of(pack.delay) * Simd::Set(1.0 / pack.dt);
    for (int n = rows - 1; n >= 0; --n)  // backwards: a sample reads earlier ones only
      Simd::Store(force(n), Gated(pack.delay_gate[static_cast<std::size_t>(n)],
                                  SensorDelay::Delayed<Simd>(series, n, lag), Simd::Load(force(n))));
  }
  if (pack.lag >= 0) {
    const SensorLag::Filter<Simd> filter(amplitude_of(pack.lag), pack.dt);
    V before = Simd::Load(force(0));
    V state = before;
    for (int n = 1; n < rows; ++n) {
      const V f = Simd::Load(force(n));
      state = filter.Next(state, f, before);
      before = f;
      Simd::Store(force(n), Gated(pack.lag_gate[static_cast<std::size_t>(n)], state, f));
    }
  }
  if (pack.limit >= 0) {
    const V limit = amplitude_of(pack.limit);
    for (int n = pack.history; n < rows; ++n) {
      const V f = Simd::Load(force(n));
      Simd::Store(force(n),
                  Gated(pack.limit_gate[static_cast<std::size_t>(n)], SensorSaturation::Clip<Simd>(f, limit), f));
    }
  }
}

void PredictSensed(const ContactPack& pack, const ThetaTile& theta, int lanes,
                   PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
  alignas(64) double series[kMaxEffectSamples * Simd::kLanes];
  for (int lane = 0; lane < lanes; lane += Simd::kLanes) {
    const auto at = static_cast<std::size_t>(lane);
    PlantForces(pack, theta, at, series);
    Sense(pack, theta, at, series);
    for (std::size_t n = 0; n < static_cast<std::size_t>(pack.num_samples); ++n)
      Simd::Store(&tile->value[n][at],
                  Simd::Load(series + (static_cast<std::size_t>(pack.history) + n) * Simd::kLanes));
  }
}

using PredictComposedFn = void (*)(const ContactPack&, const ThetaTile&, int lanes,
                                   PredictionTile*) noexcept ARMCMC_NONBLOCKING;
constexpr PredictComposedFn kPredictAdditive[] = {&PredictSensed,      &PredictAdditive<1>, &PredictAdditive<2>,
                                                  &PredictAdditive<3>, &PredictAdditive<4>, &PredictAdditive<5>};
static_assert(std::size(kPredictAdditive) == kMaxAdditive + 1);

/// The contact with additive effects only.
template <unsigned kAdditive>
struct AdditiveForward {
  static constexpr unsigned kRows = 3 + kAdditive;
  const ContactPack& pack;
  Simd::V Load(const ThetaTile& theta, unsigned i, unsigned lane) const noexcept {
    return Simd::Load(&theta.value[i < 3 ? i : static_cast<unsigned>(pack.additive_amplitude[i - 3])][lane]);
  }
  bool Far(int n) const noexcept { return std::fabs(pack.log2_x[static_cast<unsigned>(n)]) > ScoreSimd::kReach; }
  template <class S>
  Simd::V AddTo(Simd::V base, const Simd::V* theta, int n) const noexcept {
    const auto in = static_cast<unsigned>(n);
    for (unsigned a = 0; a < kAdditive; ++a) base = Simd::Fma(theta[3 + a], Simd::Set(pack.feature[a][in]), base);
    if (pack.log2_x[in] <= ContactPack::kNoDepth) return base;
    return HuntCrossley::AddLaw<S>(base, theta[0], theta[1], theta[2], pack.log2_x[in], pack.v[in]);
  }
};

template <unsigned kAdditive>
void SumSquaresAdditive(const ModeData& data, const ThetaTile& theta, double noise_mean,
                        double* out) noexcept ARMCMC_NONBLOCKING {
  SumSquaresOf(AdditiveForward<kAdditive>{static_cast<const ContactPack&>(*data.compiled)}, data, theta, noise_mean,
               out);
}

constexpr SumSquaresFn kSumSquaresAdditive[] = {&SumSquaresAdditive<0>, &SumSquaresAdditive<1>, &SumSquaresAdditive<2>,
                                                &SumSquaresAdditive<3>, &SumSquaresAdditive<4>, &SumSquaresAdditive<5>};
static_assert(std::size(kSumSquaresAdditive) == kMaxAdditive + 1);

template <>
struct PlantKernels<HuntCrossley> {
  static void Predict(const ModeData& data, const ThetaTile& theta, int lanes,
                      PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
    const auto& pack = static_cast<const ContactPack&>(*data.compiled);
    (pack.additive_only() ? kPredictAdditive[pack.num_additive] : kPredictAdditive[0])(pack, theta, lanes, tile);
  }
  static SumSquaresFn Squares(const ModeData& data) noexcept ARMCMC_NONBLOCKING {
    const auto& pack = static_cast<const ContactPack&>(*data.compiled);
    return pack.additive_only() ? kSumSquaresAdditive[pack.num_additive] : nullptr;
  }
};

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
