// Compiled once per instruction set; see vector.hpp. Everything lives in the instruction set's own namespace so that
// no other translation unit can pick up code that its CPU cannot run.

#include "simd/vector.hpp"

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

using V = Simd::V;
constexpr int kVectors = kTileLanes / Simd::kLanes;
constexpr double kLn2 = 0.69314718055994530942;
constexpr double kLog2E = 1.44269504088896340736;

/// The loops of a compiled plant with effects, whose slice specialises this in its kernels.inl:
///   Predict(data, theta, tile)   predictions from data.compiled
///   Squares(data)                the loop that sums squared errors; null where that takes the predictions
template <class Model>
struct PlantKernels;

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE

// clang-format off
#include "simd/described.inl"
#include "simd/squares.inl"
#include "plants/kernels.inl"
// clang-format on

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

template <class Model>
void PredictTile(const ModeData& data, const ThetaTile& theta, PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
  constexpr auto kDim = static_cast<unsigned>(Model::kInfo.num_parameters);
  for (int v = 0; v < kVectors; ++v) {
    V parameters[static_cast<unsigned>(kDim)];
    for (unsigned d = 0; d < kDim; ++d)
      parameters[d] = Simd::Load(&theta.value[d][static_cast<unsigned>(v * Simd::kLanes)]);
    for (int n = 0; n < data.num_samples; ++n)
      Simd::Store(&tile->value[static_cast<unsigned>(n)][static_cast<unsigned>(v * Simd::kLanes)],
                  Model::template Predict<Simd>(parameters, data, n));
  }
}

/// By index of the model: its loops without effects, then those with.
template <class List>
struct PlantTable;
template <class... Models>
struct PlantTable<ModelList<Models...>> {
  using PredictFn = void (*)(const ModeData&, const ThetaTile&, PredictionTile*) noexcept ARMCMC_NONBLOCKING;
  using SquaresFn = SumSquaresFn (*)(const ModeData&) noexcept ARMCMC_NONBLOCKING;
  static constexpr PredictFn kPlain[] = {&PredictTile<Models>...};
  static constexpr SumSquaresFn kPlainSquares[] = {&SumSquaresPlain<Models>...};
  static constexpr PredictFn kPredict[] = {&PlantKernels<Models>::Predict...};
  static constexpr SquaresFn kSquares[] = {&PlantKernels<Models>::Squares...};
};

void Predict(int model, const ModeData& data, const ThetaTile& theta,
             PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
  if (data.tape != nullptr) {
    PredictTape<kTileLanes>(data, theta, tile);
  } else {
    (data.compiled != nullptr ? PlantTable<AllModels>::kPredict : PlantTable<AllModels>::kPlain)[model](data, theta,
                                                                                                        tile);
  }
}

void PredictHalf(int model, const ModeData& data, const ThetaTile& theta,
                 PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
  if (data.tape != nullptr) {
    PredictTape<kTileLanes / 2>(data, theta, tile);
  } else {
    Predict(model, data, theta, tile);
  }
}

/// Standardised, weighted errors of one vector of lanes at sample n.
V Error(const ModeData& data, const PredictionTile& tile, int v, int n, V mean, V inverse_scale) noexcept {
  const auto k = static_cast<unsigned>(n);
  const V f = Simd::Load(&tile.value[k][static_cast<unsigned>(v * Simd::kLanes)]);
  return (Simd::Set(data.target[k]) - f - mean) * (Simd::Set(data.weight[k]) * inverse_scale);
}

/// Sums term(error) over the samples; four vectors advance together so that the additions do not wait for each other.
template <class Term>
void SumTerms(const ModeData& data, const PredictionTile& tile, double noise_mean, const double* inverse_scale,
              Term term, double* out) noexcept {
  constexpr int kGroup = kVectors < 4 ? kVectors : 4;
  const V mean = Simd::Set(noise_mean);
  for (int v0 = 0; v0 < kVectors; v0 += kGroup) {
    V sum[kGroup];
    V inv[kGroup];
    for (int g = 0; g < kGroup; ++g) {
      sum[g] = V{};
      inv[g] = Simd::Load(inverse_scale + (v0 + g) * Simd::kLanes);
    }
    for (int n = 0; n < data.num_samples; ++n)
      for (int g = 0; g < kGroup; ++g) sum[g] = term(Error(data, tile, v0 + g, n, mean, inv[g]), sum[g]);
    for (int g = 0; g < kGroup; ++g) Simd::Store(out + (v0 + g) * Simd::kLanes, sum[g]);
  }
}

/// Sums log2 factor(error) over the samples as the log of short products: one logarithm for every kRun factors.
/// Factors are in [1e-30, 1e30], so that a product of eight stays finite.
template <class Factor>
void SumLog2Products(const ModeData& data, const PredictionTile& tile, double noise_mean, const double* inverse_scale,
                     Factor factor, double* out) noexcept {
  constexpr int kRun = 8;
  const V mean = Simd::Set(noise_mean);
  for (int v = 0; v < kVectors; ++v) {
    const V inv = Simd::Load(inverse_scale + v * Simd::kLanes);
    V sum = V{};
    for (int n0 = 0; n0 < data.num_samples; n0 += kRun) {
      const int end = n0 + kRun < data.num_samples ? n0 + kRun : data.num_samples;
      V product = Simd::Set(1.0);
      for (int n = n0; n < end; ++n) {
        const V f = factor(Error(data, tile, v, n, mean, inv));
        product = product * Simd::Min(Simd::Max(f, Simd::Set(1e-30)), Simd::Set(1e30));
      }
      sum = sum + Simd::Log2(product);
    }
    Simd::Store(out + v * Simd::kLanes, sum);
  }
}

void LogLikelihood(const NoiseModel& noise, const ModeData& data, const PredictionTile& tile, const double* log_scale,
                   double* out) noexcept ARMCMC_NONBLOCKING {
  alignas(64) double inverse_scale[kTileLanes];
  for (int v = 0; v < kVectors; ++v)
    Simd::Store(inverse_scale + v * Simd::kLanes,
                Simd::Exp2(Simd::Load(log_scale + v * Simd::kLanes) * Simd::Set(-kLog2E)));
  const NoiseSettings& s = noise.settings();
  double slope = 0.0;  // log-likelihood = slope * sum + samples * (constant - log scale)
  switch (s.kind) {
    case NoiseKind::kGaussian:
      slope = -0.5;
      SumTerms(
          data, tile, s.mean, inverse_scale, [](V e, V sum) { return Simd::Fma(e, e, sum); }, out);
      break;
    case NoiseKind::kLaplace:
      slope = -1.0;
      SumTerms(
          data, tile, s.mean, inverse_scale, [](V e, V sum) { return sum + Simd::Abs(e); }, out);
      break;
    case NoiseKind::kStudentT: {
      slope = -0.5 * (s.dof + 1.0) * kLn2;
      const V inverse_dof = Simd::Set(1.0 / s.dof);
      SumLog2Products(
          data, tile, s.mean, inverse_scale, [=](V e) { return Simd::Fma(e * inverse_dof, e, Simd::Set(1.0)); }, out);
      break;
    }
    case NoiseKind::kMixture: {
      // p(e) = N(e; c) [(1 - w) exp(-e^2/2 (1 - 1/c^2)) + w / c]: the bracket lies in [w / c, 1 + w / c].
      slope = kLn2;
      const double c2 = 1.0 / (s.outlier_scale * s.outlier_scale);
      const V inlier_rate = Simd::Set(-0.5 * kLog2E * (1.0 - c2));
      const V inlier = Simd::Set(1.0 - s.outlier_weight);
      const V outlier = Simd::Set(s.outlier_weight / s.outlier_scale);
      alignas(64) double wide[kTileLanes];
      SumTerms(
          data, tile, s.mean, inverse_scale, [](V e, V sum) { return Simd::Fma(e, e, sum); }, wide);
      SumLog2Products(
          data, tile, s.mean, inverse_scale,
          [=](V e) { return Simd::Fma(inlier, Simd::Exp2(inlier_rate * e * e), outlier); }, out);
      const V wide_rate = Simd::Set(-0.5 * kLog2E * c2);
      for (int v = 0; v < kVectors; ++v)
        Simd::Store(out + v * Simd::kLanes,
                    Simd::Fma(wide_rate, Simd::Load(wide + v * Simd::kLanes), Simd::Load(out + v * Simd::kLanes)));
      break;
    }
  }
  const V samples = Simd::Set(static_cast<double>(data.num_samples));
  const V constant = Simd::Set(noise.log_constant());
  for (int v = 0; v < kVectors; ++v) {
    const V per_sample = constant - Simd::Load(log_scale + v * Simd::kLanes);
    Simd::Store(out + v * Simd::kLanes,
                Simd::Fma(Simd::Set(slope), Simd::Load(out + v * Simd::kLanes), samples * per_sample));
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
#include "simd/elementary.inl"
#include "simd/moments.inl"
#include "simd/quadratic.inl"
#include "simd/score.inl"
#include "simd/weights.inl"
