// Densities that can be drawn and evaluated; included by kernels.inl, once per instruction set.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// Linear interpolation in a marginal table at a place counted in nodes from its lower end, 0 outside.
[[gnu::always_inline]] inline V TableDensity(const MarginalTable& table, V place) noexcept {
  const V zero{};
  const double end = table.num_nodes() - 1;
  const Simd::I inside = (place >= zero) & (place < Simd::Set(end));
  const V p = Simd::Min(Simd::Max(place, zero), Simd::Set(end * (1.0 - 0x1p-53)));
  // floor(p) for 0 <= p < 2^31: the integer bits of p - 1/2 + 1.5 * 2^52 round to the node or, at a tie, to a neighbour
  // whose interpolation gives the same value.
  const V magic = Simd::Set(6755399441055744.0);
  const V shifted = p - Simd::Set(0.5) + magic;
  const Simd::I index = Simd::Bits(shifted) - Simd::Bits(magic);
  V low, high;
  Simd::GatherPairs(table.pdf(), index, &low, &high);
  return Simd::Select(inside, Simd::Fma(p - (shifted - magic), high - low, low), zero);
}

/// What straightening subtracts from z_i; see DensityBlock.
[[gnu::always_inline]] inline V Bend(const DensityBlock& block, int i, V c, const V* e) noexcept {
  const auto ii = static_cast<unsigned>(i);
  V bend = Simd::Set(block.poly[ii][DensityBlock::kDegree]);
  for (int k = DensityBlock::kDegree - 1; k >= 0; --k)
    bend = Simd::Fma(bend, c, Simd::Set(block.poly[ii][static_cast<unsigned>(k)]));
  if (i < 2) return bend;
  bend = Simd::Fma(e[1], Simd::Fma(Simd::Set(block.square[ii]), e[1], Simd::Set(block.cross[ii]) * c), bend);
  for (int j = 1; j < i; ++j) bend = Simd::Fma(Simd::Set(block.linear[ii][static_cast<unsigned>(j)]), e[j], bend);
  return bend;
}

/// Straightened coordinates of one vector of candidates; e[0] clamped goes to *c. Inlined, so that they stay in
/// registers.
template <int kDim>
[[gnu::always_inline]] inline void StraightenVector(const DensityBlock& block, const double* const* u, int at, V* e,
                                                    V* c) noexcept {
  V centered[static_cast<unsigned>(kDim)];
  for (int d = 0; d < kDim; ++d) centered[d] = Simd::Load(u[d] + at) - Simd::Set(block.mean[static_cast<unsigned>(d)]);
  for (int i = 0; i < kDim; ++i) {
    if (block.axis_aligned) {
      e[i] = centered[i];
      continue;
    }
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

/// alpha_i t + beta_i t^2, t = c within kTaperReach.
V LogThickness(const DensityBlock& block, int i, V c) noexcept {
  const V reach = Simd::Set(DensityBlock::kTaperReach);
  const V t = Simd::Min(Simd::Max(c, -reach), reach);
  const auto& coefficient = block.thickness[static_cast<unsigned>(i)];
  return t * Simd::Fma(Simd::Set(coefficient[1]), t, Simd::Set(coefficient[0]));
}

/// Inverse CDF of a marginal table; the vector form of MarginalTable::Draw.
V TableDraw(const MarginalTable& table, V u) noexcept {
  const V magic = Simd::Set(6755399441055744.0);
  // Down to the guide cell at or below u: half a cell is taken off before rounding to nearest.
  const V cell = Simd::Max(u * Simd::Set(MarginalTable::kGuideSize) - Simd::Set(0.5), V{}) + magic;
  Simd::I node = Simd::Bits(cell) - Simd::Bits(magic);
  alignas(64) std::int64_t at[Simd::kLanes];
  std::memcpy(at, &node, sizeof at);
  for (std::int64_t& lane : at) lane = table.guide()[lane];
  std::memcpy(&node, at, sizeof at);
  static_assert(sizeof(MarginalTable::Interval) == 4 * sizeof(double));
  V interval[4];
  for (int step = 0; step < MarginalTable::kMaxNodes; ++step) {
    Simd::GatherRows(&table.intervals()->cdf, at, interval);
    const Simd::I behind = interval[1] < u;
    if (!Simd::Any(behind)) break;
    node -= behind;
    std::memcpy(at, &node, sizeof at);
  }
  const V f0 = interval[2];
  const V slope = (interval[3] - f0) * Simd::Set(MarginalTable::kNodesPerUnit);
  const V rest = Simd::Max(u - interval[0], V{});
  const V root = Simd::Sqrt(Simd::Max(Simd::Fma(f0, f0, Simd::Set(2.0) * slope * rest), V{}));
  const V width = Simd::Set(1.0 / MarginalTable::kNodesPerUnit);
  const V denominator = Simd::Max(f0 + root, Simd::Set(1e-300));
  const V place = Simd::FromBits(node + Simd::Bits(magic)) - magic;
  return Simd::Set(table.lower()) + place * width + Simd::Min(Simd::Set(2.0) * rest / denominator, width);
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

void DrawBlock(const DensityBlock& block, int count, double* const* x) noexcept ARMCMC_NONBLOCKING {
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

void AddDensity(const DensityBlock& block, const double* const* u, int first, double factor,
                double* out) noexcept ARMCMC_NONBLOCKING {
  ForDimension(block.dim, [&]<int kDim>() noexcept { AddDensityOf<kDim>(block, u, first, factor, out); });
}

template <int kDim>
void StraightenForDimension(const DensityBlock& block, const double* const* u, int count, double* const* e) noexcept {
  for (int k = 0; k < count; k += Simd::kLanes) {
    V straight[static_cast<unsigned>(kDim)];
    V c;
    StraightenVector<kDim>(block, u, k, straight, &c);
    for (int i = 0; i < kDim; ++i) Simd::Store(e[i] + k, straight[i]);
  }
}

void Straighten(const DensityBlock& block, const double* const* u, int count,
                double* const* e) noexcept ARMCMC_NONBLOCKING {
  ForDimension(block.dim, [&]<int kDim>() noexcept { StraightenForDimension<kDim>(block, u, count, e); });
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
