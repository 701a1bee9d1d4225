// Weighted sums over draws; included by kernels.inl, once per instruction set.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

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

void FirstMoments(int dim, const double* const* u, const double* w, int count,
                  double* sums) noexcept ARMCMC_NONBLOCKING {
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
                   double* sums) noexcept ARMCMC_NONBLOCKING {
  static_assert(kMaxMomentRows == kMaxParams + 2);
  if (dim == kMaxParams + 1) {
    SecondMomentsOf<kMaxParams + 1>(u, w, mean, count, sums);
  } else if (dim == kMaxParams + 2) {
    SecondMomentsOf<kMaxParams + 2>(u, w, mean, count, sums);
  } else {
    ForDimension(dim, [&]<int kDim>() noexcept { SecondMomentsOf<kDim>(u, w, mean, count, sums); });
  }
}

void BendMoments(int dim, const double* const* z, const double* w, int count,
                 double* sums) noexcept ARMCMC_NONBLOCKING {
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

void Histogram(const double* e, const double* w, int count, double per_node, double origin, int num_nodes,
               double* cells) noexcept ARMCMC_NONBLOCKING {
  typedef double Cell __attribute__((vector_size(16)));  // weight, and the part of it that goes to the upper node
  const V end = Simd::Set(num_nodes - 1.001);
  const V magic = Simd::Set(6755399441055744.0);  // as in TableDensity
  alignas(64) double upper[8];
  alignas(64) std::int64_t cell[8];
  for (int k = 0; k < count; k += 8) {
    for (int p = 0; p < 8; p += Simd::kLanes) {
      const V place = Simd::Fma(Simd::Load(e + k + p), Simd::Set(per_node), Simd::Set(origin));
      const V inside = Simd::Min(Simd::Max(place, V{}), end);
      const V shifted = inside - Simd::Set(0.5) + magic;
      const Simd::I index = Simd::Bits(shifted) - Simd::Bits(magic);
      std::memcpy(cell + p, &index, sizeof index);
      Simd::Store(upper + p, Simd::Load(w + k + p) * (inside - (shifted - magic)));
    }
    for (int l = 0; l < 8; ++l) {
      double* const to = cells + 2 * cell[l];
      Cell sum;
      std::memcpy(&sum, to, sizeof sum);
      sum += Cell{w[k + l], upper[l]};
      std::memcpy(to, &sum, sizeof sum);
    }
  }
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
