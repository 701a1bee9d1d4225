// Compiled once per instruction set; see vector.hpp. Everything lives in the instruction set's own namespace so that
// no other translation unit can pick up code that its CPU cannot run.

#include "simd/vector.hpp"

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

using V = Simd::V;
constexpr int kVectors = kTileLanes / Simd::kLanes;
constexpr double kLn2 = 0.69314718055994530942;
constexpr double kLog2E = 1.44269504088896340736;

/// The loops of a compiled plant with effects, whose folder specialises this in its kernels.inl:
///   Predict(data, theta, lanes, tile)   predictions from data.compiled, of that many lanes, half a tile or all of it
///   Squares(data)                       the loop that sums squared errors; null where that takes the predictions
template <class Model>
struct PlantKernels;

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE

// clang-format off
#include "simd/noise_laws.inl"
#include "simd/described.inl"
#include "simd/squares.inl"
#include "plants/kernels.inl"
// clang-format on

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// Of the first kSize candidates. Several vectors advance together, as in SumSquares().
template <class Model, int kSize>
void PredictTile(const ModeData& data, const ThetaTile& theta, PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
  constexpr auto kDim = static_cast<unsigned>(Model::kInfo.num_parameters);
  constexpr int kGroup = kSize / Simd::kLanes < 4 ? kSize / Simd::kLanes : 4;
  for (int v0 = 0; v0 < kSize / Simd::kLanes; v0 += kGroup) {
    V parameters[static_cast<unsigned>(kGroup)][kDim];
    for (int g = 0; g < kGroup; ++g)
      for (unsigned d = 0; d < kDim; ++d)
        parameters[g][d] = Simd::Load(&theta.value[d][static_cast<unsigned>((v0 + g) * Simd::kLanes)]);
    for (int n = 0; n < data.num_samples; ++n)
      for (int g = 0; g < kGroup; ++g)
        Simd::Store(&tile->value[static_cast<unsigned>(n)][static_cast<unsigned>((v0 + g) * Simd::kLanes)],
                    Model::template Predict<Simd>(parameters[g], data, n));
  }
}

/// By index of the model: its loops without effects, then those with.
template <class List>
struct PlantTable;
template <class... Models>
struct PlantTable<ModelList<Models...>> {
  using PredictFn = void (*)(const ModeData&, const ThetaTile&, PredictionTile*) noexcept ARMCMC_NONBLOCKING;
  using SquaresFn = SumSquaresFn (*)(const ModeData&) noexcept ARMCMC_NONBLOCKING;
  static constexpr PredictFn kPlain[] = {&PredictTile<Models, kTileLanes>...};
  static constexpr PredictFn kPlainHalf[] = {&PredictTile<Models, kTileLanes / 2>...};
  static constexpr SumSquaresFn kPlainSquares[] = {&SumSquaresPlain<Models>...};
  static constexpr ScoreLawFn kPlainScoreLaw[] = {&ScoreLawPlain<Models>...};
  using ExpandPowerFn = void (*)(const ModeData&, const double*, const double*,
                                 PowerSeries*) noexcept ARMCMC_NONBLOCKING;
  using ScoreNearFn = void (*)(const PowerSeries*, const ModeData&, const ThetaTile&, const NoiseModel&, const double*,
                               int, double*) noexcept ARMCMC_NONBLOCKING;
  static constexpr ExpandPowerFn kExpandPower[] = {&ExpandPowerPlain<Models>...};
  static constexpr ScoreNearFn kScoreNear[] = {&ScoreNearPlain<Models>...};
  using PredictLanesFn = void (*)(const ModeData&, const ThetaTile&, int, PredictionTile*) noexcept ARMCMC_NONBLOCKING;
  static constexpr PredictLanesFn kPredict[] = {&PlantKernels<Models>::Predict...};
  static constexpr SquaresFn kSquares[] = {&PlantKernels<Models>::Squares...};
};

void Predict(int model, const ModeData& data, const ThetaTile& theta,
             PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
  if (data.tape != nullptr) {
    PredictTape<kTileLanes>(data, theta, tile);
  } else if (data.compiled != nullptr) {
    PlantTable<AllModels>::kPredict[model](data, theta, kTileLanes, tile);
  } else {
    PlantTable<AllModels>::kPlain[model](data, theta, tile);
  }
}

void PredictHalf(int model, const ModeData& data, const ThetaTile& theta,
                 PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
  if (data.tape != nullptr) {
    PredictTape<kTileLanes / 2>(data, theta, tile);
  } else if (data.compiled != nullptr) {
    PlantTable<AllModels>::kPredict[model](data, theta, kTileLanes / 2, tile);
  } else {
    PlantTable<AllModels>::kPlainHalf[model](data, theta, tile);
  }
}

void InitialPrior(const ParameterSpace& space, const double* const* u, int first,
                  double* out) noexcept ARMCMC_NONBLOCKING {
  for (int v = 0; v < kVectors; ++v) {
    V square = V{};
    Simd::I inside = Simd::I{} - 1;
    for (int d = 0; d < space.dim; ++d) {
      const auto i = static_cast<unsigned>(d);
      const V x = Simd::Load(u[d] + first + v * Simd::kLanes);
      square = Simd::Fma(x * Simd::Set(space.normal[i]), x, square);
      inside &= (x >= Simd::Set(space.lower[i])) & (x <= Simd::Set(space.upper[i]));
    }
    const V p = Simd::Set(space.norm) * Simd::Exp2(square * Simd::Set(-0.5 * kLog2E));
    Simd::Store(out + v * Simd::kLanes, Simd::Select(inside, p, V{}));
  }
}

void ToPhysical(const ParameterSpace& space, const double* const* u, int first, ThetaTile* theta,
                double* log_scale) noexcept ARMCMC_NONBLOCKING {
  for (int v = 0; v < kVectors; ++v) {
    const int lane = v * Simd::kLanes;
    for (int d = 0; d < space.dim; ++d) {
      const auto i = static_cast<unsigned>(d);
      const V x = Simd::Fma(Simd::Set(space.scale[i]), Simd::Load(u[d] + first + lane), Simd::Set(space.offset[i]));
      Simd::Store(d < space.num_parameters ? &theta->value[i][static_cast<unsigned>(lane)] : log_scale + lane, x);
    }
    if (!space.samples_noise_scale()) Simd::Store(log_scale + lane, Simd::Set(space.log_noise_scale));
  }
}

void RelativeLikelihood(const double* log_likelihood, double reference, int count,
                        double* out) noexcept ARMCMC_NONBLOCKING {
  for (int k = 0; k < count; k += Simd::kLanes)
    Simd::Store(out + k, Simd::Exp2((Simd::Load(log_likelihood + k) - Simd::Set(reference)) * Simd::Set(kLog2E)));
}

/// RandomStream::Uniform() of number `index`.
double UniformAt(std::uint64_t origin, std::uint64_t index) noexcept {
  return (static_cast<double>(static_cast<std::int64_t>(RandomStream::At(origin, index) >> 12)) + 0.5) * 0x1p-52;
}

void Uniforms(std::uint64_t origin, std::uint64_t first, std::uint64_t stride, int count,
              double* out) noexcept ARMCMC_NONBLOCKING {
  for (int k = 0; k < count; ++k) out[k] = UniformAt(origin, first + static_cast<std::uint64_t>(k) * stride);
}

void UniformsOf(std::uint64_t origin, std::uint64_t first, std::uint64_t stride, const std::int16_t* member, int count,
                double* out) noexcept ARMCMC_NONBLOCKING {
  for (int k = 0; k < count; ++k) out[k] = UniformAt(origin, first + static_cast<std::uint64_t>(member[k]) * stride);
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE

#include "simd/density.inl"
#include "simd/drift_factor.inl"
#include "simd/elementary.inl"
#include "simd/moments.inl"
#include "simd/quadratic.inl"
#include "simd/score.inl"
#include "simd/weights.inl"
