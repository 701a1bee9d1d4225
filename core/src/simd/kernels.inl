// Compiled once per instruction set; see vector.hpp. Everything lives in the instruction set's own namespace so that
// no other translation unit can pick up code that its CPU cannot run.

// The effects are written in the terms of vector.hpp.
// clang-format off
#include "simd/vector.hpp"
#include "simd/effects.inl"
// clang-format on

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

using V = Simd::V;
constexpr int kVectors = kTileLanes / Simd::kLanes;
constexpr double kLn2 = 0.69314718055994530942;
constexpr double kLog2E = 1.44269504088896340736;

template <class Model>
void PredictTile(const ModeData& data, const ThetaTile& theta, PredictionTile* tile) noexcept {
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

template <class... Models>
void PredictAny(ModelList<Models...>, int model, const ModeData& data, const ThetaTile& theta,
                PredictionTile* tile) noexcept {
  using Fn = void (*)(const ModeData&, const ThetaTile&, PredictionTile*) noexcept;
  static constexpr Fn kTable[] = {&PredictTile<Models>...};
  kTable[model](data, theta, tile);
}

void Predict(int model, const ModeData& data, const ThetaTile& theta, PredictionTile* tile) noexcept {
  if (data.effects != nullptr) {
    PredictComposed(*data.effects, theta, tile);
    return;
  }
  PredictAny(AllModels{}, model, data, theta, tile);
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
                   double* out) noexcept {
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

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE

#include "simd/score.inl"

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// Linear interpolation in a marginal table at a place counted in nodes from its lower end, 0 outside.
V TableDensity(const MarginalTable& table, V place) noexcept {
  const V zero{};
  const double end = table.num_nodes() - 1;
  const Simd::I inside = (place >= zero) & (place < Simd::Set(end));
  const V p = Simd::Min(Simd::Max(place, zero), Simd::Set(end * (1.0 - 0x1p-53)));
  // floor(p) for 0 <= p < 2^31: the integer bits of p - 1/2 + 1.5 * 2^52 round to the node or, at a tie, to a neighbour
  // whose interpolation gives the same value.
  const V magic = Simd::Set(6755399441055744.0);
  const V shifted = p - Simd::Set(0.5) + magic;
  const Simd::I index = Simd::Bits(shifted) - Simd::Bits(magic);
  const V low = Simd::Gather(table.pdf(), index);
  const V high = Simd::Gather(table.pdf() + 1, index);
  return Simd::Select(inside, Simd::Fma(p - (shifted - magic), high - low, low), zero);
}

/// What straightening subtracts from z_i; see DensityBlock.
V Bend(const DensityBlock& block, int i, V c, const V* e) noexcept {
  const auto ii = static_cast<unsigned>(i);
  V bend = Simd::Set(block.poly[ii][DensityBlock::kDegree]);
  for (int k = DensityBlock::kDegree - 1; k >= 0; --k)
    bend = Simd::Fma(bend, c, Simd::Set(block.poly[ii][static_cast<unsigned>(k)]));
  if (i < 2) return bend;
  bend = Simd::Fma(e[1], Simd::Fma(Simd::Set(block.square[ii]), e[1], Simd::Set(block.cross[ii]) * c), bend);
  for (int j = 1; j < i; ++j) bend = Simd::Fma(Simd::Set(block.linear[ii][static_cast<unsigned>(j)]), e[j], bend);
  return bend;
}

/// Straightened coordinates of one vector of candidates; e[0] clamped goes to *c.
template <int kDim>
void StraightenVector(const DensityBlock& block, const double* const* u, int at, V* e, V* c) noexcept {
  V centered[static_cast<unsigned>(kDim)];
  for (int d = 0; d < kDim; ++d) centered[d] = Simd::Load(u[d] + at) - Simd::Set(block.mean[static_cast<unsigned>(d)]);
  for (int i = 0; i < kDim; ++i) {
    V sum = V{};
    for (int d = 0; d < kDim; ++d)
      sum = Simd::Fma(Simd::Set(block.whiten[static_cast<unsigned>(i)][static_cast<unsigned>(d)]), centered[d], sum);
    e[i] = sum;
  }
  const V reach = Simd::Set(DensityBlock::kBendReach);
  *c = Simd::Min(Simd::Max(e[0], -reach), reach);
  if (!block.bent) return;
  for (int i = 1; i < kDim; ++i) e[i] = e[i] - Bend(block, i, *c, e);
}

/// alpha_i c + beta_i c^2.
V LogThickness(const DensityBlock& block, int i, V c) noexcept {
  const auto& t = block.thickness[static_cast<unsigned>(i)];
  return c * Simd::Fma(Simd::Set(t[1]), c, Simd::Set(t[0]));
}

/// Inverse CDF of a marginal table; the vector form of MarginalTable::Draw.
V TableDraw(const MarginalTable& table, V u) noexcept {
  const V magic = Simd::Set(6755399441055744.0);
  const V last = Simd::Set(table.num_nodes() - 2);
  const V one = Simd::Set(1.0);
  const auto index_of = [&](V node) noexcept { return Simd::Bits(node + magic) - Simd::Bits(magic); };
  // Down to the guide cell at or below u: half a cell is taken off before rounding to nearest.
  const V cell = Simd::Max((u * Simd::Set(MarginalTable::kGuideSize) - Simd::Set(0.5) + magic) - magic, V{});
  V node = Simd::Gather(table.guide(), index_of(cell));
  for (int step = 0; step < MarginalTable::kMaxNodes; ++step) {
    const V next = Simd::Gather(table.cdf() + 1, index_of(node));
    const Simd::I behind = (next < u) & (node < last);
    if (!Simd::Any(behind)) break;
    node = Simd::Select(behind, node + one, node);
  }
  const Simd::I index = index_of(node);
  const V f0 = Simd::Gather(table.pdf(), index);
  const V slope = (Simd::Gather(table.pdf() + 1, index) - f0) * Simd::Set(MarginalTable::kNodesPerUnit);
  const V rest = Simd::Max(u - Simd::Gather(table.cdf(), index), V{});
  const V root = Simd::Sqrt(Simd::Max(Simd::Fma(f0, f0, Simd::Set(2.0) * slope * rest), V{}));
  const V step = Simd::Set(1.0 / MarginalTable::kNodesPerUnit);
  const V denominator = Simd::Max(f0 + root, Simd::Set(1e-300));
  return Simd::Set(table.lower()) + node * step + Simd::Min(Simd::Set(2.0) * rest / denominator, step);
}

/// fn.template operator()<dim>(), the dimension known to the compiler.
template <class Fn>
void ForDimension(int dim, const Fn& fn) noexcept {
  static_assert(kMaxParams == 8);
  switch (dim) {
    case 1: fn.template operator()<1>(); break;
    case 2: fn.template operator()<2>(); break;
    case 3: fn.template operator()<3>(); break;
    case 4: fn.template operator()<4>(); break;
    case 5: fn.template operator()<5>(); break;
    case 6: fn.template operator()<6>(); break;
    case 7: fn.template operator()<7>(); break;
    case 8: fn.template operator()<8>(); break;
    default: break;
  }
}

template <int kDim>
void DrawBlockOf(const DensityBlock& block, int count, double* const* x) noexcept {
  const V reach = Simd::Set(DensityBlock::kBendReach);
  for (int k = 0; k < count; k += Simd::kLanes) {
    V e[static_cast<unsigned>(kDim)];
    V z[static_cast<unsigned>(kDim)];
    V c{};
    for (int i = 0; i < kDim; ++i) {
      const auto ii = static_cast<unsigned>(i);
      e[i] = Simd::Fma(Simd::Set(block.scale[ii]), TableDraw(*block.marginal[ii], Simd::Load(x[i] + k)),
                       Simd::Set(block.center[ii]));
      z[i] = e[i];
      if (i == 0) c = Simd::Min(Simd::Max(e[0], -reach), reach);
      if (!block.bent || i == 0) continue;
      if (block.tapered && block.Tapers(i)) e[i] = e[i] * Simd::Exp2(LogThickness(block, i, c) * Simd::Set(kLog2E));
      z[i] = e[i] + Bend(block, i, c, e);
    }
    for (int i = 0; i < kDim; ++i) {
      const auto& row = block.unwhiten[static_cast<unsigned>(i)];
      V sum = Simd::Set(block.mean[static_cast<unsigned>(i)]);
      for (int j = 0; j < kDim; ++j) sum = Simd::Fma(Simd::Set(row[static_cast<unsigned>(j)]), z[j], sum);
      Simd::Store(x[i] + k, sum);
    }
  }
}

void DrawBlock(const DensityBlock& block, int count, double* const* x) noexcept {
  ForDimension(block.dim, [&]<int kDim>() noexcept { DrawBlockOf<kDim>(block, count, x); });
}

template <int kDim>
void AddDensityOf(const DensityBlock& block, const double* const* u, int first, double factor, double* out) noexcept {
  // From a straightened coordinate to its place in the table: one multiplication and one addition.
  double per_node[static_cast<unsigned>(kDim)];
  double origin[static_cast<unsigned>(kDim)];
  for (int i = 0; i < kDim; ++i) {
    const auto ii = static_cast<unsigned>(i);
    per_node[i] = MarginalTable::kNodesPerUnit / block.scale[ii];
    origin[i] = -block.center[ii] * per_node[i] - block.marginal[ii]->lower() * MarginalTable::kNodesPerUnit;
  }
  for (int v = 0; v < kVectors; ++v) {
    V e[static_cast<unsigned>(kDim)];
    V c;
    StraightenVector<kDim>(block, u, first + v * Simd::kLanes, e, &c);
    V p = Simd::Set(block.norm * factor);
    for (int i = 0; i < kDim; ++i) {
      const auto ii = static_cast<unsigned>(i);
      if (block.tapered && block.Tapers(i)) {
        const V shrink = Simd::Exp2(LogThickness(block, i, c) * Simd::Set(-kLog2E));
        e[i] = e[i] * shrink;
        p = p * shrink;
      }
      p = p * TableDensity(*block.marginal[ii], Simd::Fma(e[i], Simd::Set(per_node[i]), Simd::Set(origin[i])));
    }
    Simd::Store(out + v * Simd::kLanes, Simd::Load(out + v * Simd::kLanes) + p);
  }
}

void AddDensity(const DensityBlock& block, const double* const* u, int first, double factor, double* out) noexcept {
  ForDimension(block.dim, [&]<int kDim>() noexcept { AddDensityOf<kDim>(block, u, first, factor, out); });
}

void InitialPrior(const ParameterSpace& space, const double* const* u, int first, double* out) noexcept {
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
                double* log_scale) noexcept {
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

void RelativeLikelihood(const double* log_likelihood, double reference, int count, double* out) noexcept {
  for (int k = 0; k < count; k += Simd::kLanes)
    Simd::Store(out + k, Simd::Exp2((Simd::Load(log_likelihood + k) - Simd::Set(reference)) * Simd::Set(kLog2E)));
}

/// N running sums of eight lanes each, whatever the vector length, added up in lane order: the same bits everywhere.
template <unsigned N>
struct Sums {
  static constexpr unsigned kParts = 8 / Simd::kLanes;
  V part[N][kParts] = {};
  void Add(int i, unsigned p, V value) noexcept { part[i][p] = part[i][p] + value; }
  double Total(int i) const noexcept {
    alignas(64) double lanes[8];
    for (unsigned p = 0; p < kParts; ++p) Simd::Store(lanes + p * Simd::kLanes, part[i][p]);
    double total = 0.0;
    for (const double lane : lanes) total += lane;
    return total;
  }
};

void Uniforms(std::uint64_t origin, std::uint64_t first, std::uint64_t stride, int count, double* out) noexcept {
  for (int k = 0; k < count; ++k)
    out[k] = (static_cast<double>(static_cast<std::int64_t>(
                  RandomStream::At(origin, first + static_cast<std::uint64_t>(k) * stride) >> 12)) +
              0.5) *
             0x1p-52;
}

template <int kDim>
void FirstMomentsOf(const double* const* u, const double* w, int count, double* sums) noexcept {
  Sums<static_cast<unsigned>(2 + kDim)> s;
  for (int k = 0; k < count; k += 8)
    for (unsigned p = 0; p < Sums<1>::kParts; ++p) {
      const int at = k + static_cast<int>(p) * Simd::kLanes;
      const V weight = Simd::Load(w + at);
      s.Add(0, p, weight);
      s.Add(1, p, weight * weight);
      for (int d = 0; d < kDim; ++d) s.Add(2 + d, p, weight * Simd::Load(u[d] + at));
    }
  for (int i = 0; i < 2 + kDim; ++i) sums[i] = s.Total(i);
}

void FirstMoments(int dim, const double* const* u, const double* w, int count, double* sums) noexcept {
  if (dim == 0) {
    FirstMomentsOf<0>(u, w, count, sums);
    return;
  }
  ForDimension(dim, [&]<int kDim>() noexcept { FirstMomentsOf<kDim>(u, w, count, sums); });
}

template <int kDim>
void SecondMomentsOf(const double* const* u, const double* w, const double* mean, int count, double* sums) noexcept {
  Sums<static_cast<unsigned>(kDim * (kDim + 1) / 2)> s;
  for (int k = 0; k < count; k += 8)
    for (unsigned p = 0; p < Sums<1>::kParts; ++p) {
      const int at = k + static_cast<int>(p) * Simd::kLanes;
      const V weight = Simd::Load(w + at);
      V c[static_cast<unsigned>(kDim)];
      int t = 0;
      for (int i = 0; i < kDim; ++i) {
        c[i] = Simd::Load(u[i] + at) - Simd::Set(mean[i]);
        const V wc = weight * c[i];
        for (int j = 0; j <= i; ++j) s.Add(t++, p, wc * c[j]);
      }
    }
  for (int i = 0; i < kDim * (kDim + 1) / 2; ++i) sums[i] = s.Total(i);
}

void SecondMoments(int dim, const double* const* u, const double* w, const double* mean, int count,
                   double* sums) noexcept {
  static_assert(kMaxMomentRows == kMaxParams + 2);
  if (dim == kMaxParams + 1) {
    SecondMomentsOf<kMaxParams + 1>(u, w, mean, count, sums);
  } else if (dim == kMaxParams + 2) {
    SecondMomentsOf<kMaxParams + 2>(u, w, mean, count, sums);
  } else {
    ForDimension(dim, [&]<int kDim>() noexcept { SecondMomentsOf<kDim>(u, w, mean, count, sums); });
  }
}

template <int kDim>
void StraightenOf(const DensityBlock& block, const double* const* u, int count, double* const* e) noexcept {
  for (int k = 0; k < count; k += Simd::kLanes) {
    V straight[static_cast<unsigned>(kDim)];
    V c;
    StraightenVector<kDim>(block, u, k, straight, &c);
    for (int i = 0; i < kDim; ++i) Simd::Store(e[i] + k, straight[i]);
  }
}

void Straighten(const DensityBlock& block, const double* const* u, int count, double* const* e) noexcept {
  ForDimension(block.dim, [&]<int kDim>() noexcept { StraightenOf<kDim>(block, u, count, e); });
}

void BendMoments(int dim, const double* const* z, const double* w, int count, double* sums) noexcept {
  constexpr int kPowers = DensityBlock::kDegree + 1;
  constexpr int kGram = 2 * DensityBlock::kDegree + 1;
  Sums<kGram + kPowers * kMaxParams> s;
  const V reach = Simd::Set(DensityBlock::kBendReach);
  for (int k = 0; k < count; k += 8)
    for (unsigned p = 0; p < Sums<1>::kParts; ++p) {
      const int at = k + static_cast<int>(p) * Simd::kLanes;
      const V c = Simd::Min(Simd::Max(Simd::Load(z[0] + at), -reach), reach);
      V power[kGram];
      power[0] = Simd::Load(w + at);
      for (int q = 1; q < kGram; ++q) power[q] = power[q - 1] * c;
      int t = 0;
      for (int q = 0; q < kGram; ++q) s.Add(t++, p, power[q]);
      for (int d = 1; d < dim; ++d) {
        const V zd = Simd::Load(z[d] + at);
        for (int q = 0; q < kPowers; ++q) s.Add(t++, p, power[q] * zd);
      }
    }
  for (int i = 0; i < kGram + kPowers * (dim - 1); ++i) sums[i] = s.Total(i);
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE

#include "simd/weights.inl"
