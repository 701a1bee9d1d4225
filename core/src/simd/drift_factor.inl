// The likelihood of parameters that drift while a pack is recorded; included by kernels.inl, once per instruction set.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// -(d log p / de) of an error at a scale, as NoiseModel::SquareWeight has it.
template <NoiseKind kKind>
[[gnu::always_inline]] inline V ScoreOf(const NoiseSettings& s, V e, V inverse) noexcept {
  const V z = e * inverse;
  if constexpr (kKind == NoiseKind::kStudentT)
    return inverse * z * Simd::Set(s.dof + 1.0) / Simd::Fma(z, z, Simd::Set(s.dof));
  if constexpr (kKind == NoiseKind::kLaplace) return inverse * z / Simd::Max(Simd::Abs(z), Simd::Set(0.5));
  if constexpr (kKind == NoiseKind::kMixture) {
    const double wide = 1.0 / (s.outlier_scale * s.outlier_scale);
    const V inlier = Simd::Set(1.0 - s.outlier_weight) * Simd::Exp2(z * z * Simd::Set(-0.5 * kLog2E * (1.0 - wide)));
    const double outlier = s.outlier_weight / s.outlier_scale;
    return inverse * z * (inlier + Simd::Set(outlier * wide)) / (inlier + Simd::Set(outlier));
  }
  return inverse * z;
}

/// a of DriftFactor: a[d][lane] = sum_n lever_d[n] times the score of the error.
template <int kDim, NoiseKind kKind>
void LeverSums(const DriftFactor& factor, const NoiseSettings& s, const ModeData& data, const PredictionTile& tile,
               const double* log_scale, double (*a)[kTileLanes]) noexcept {
  constexpr int kGroup = 2;
  const V mean = Simd::Set(s.mean);
  for (int v0 = 0; v0 < kVectors; v0 += kGroup) {
    V inverse[static_cast<unsigned>(kGroup)];
    V sum[static_cast<unsigned>(kGroup)][static_cast<unsigned>(kDim)] = {};
    InverseScale<kGroup>(log_scale + v0 * Simd::kLanes, inverse);
    for (int n = 0; n < data.num_samples; ++n) {
      const auto k = static_cast<unsigned>(n);
      const V target = Simd::Set(data.target[k]);
      const V weight = Simd::Set(data.weight[k]);
      for (int g = 0; g < kGroup; ++g) {
        const V f = Simd::Load(&tile.value[k][static_cast<unsigned>((v0 + g) * Simd::kLanes)]);
        const V score = ScoreOf<kKind>(s, (target - f - mean) * weight, inverse[g]);
        for (int d = 0; d < kDim; ++d) sum[g][d] = Simd::Fma(Simd::Set(factor.lever[d][n]), score, sum[g][d]);
      }
    }
    for (int g = 0; g < kGroup; ++g)
      for (int d = 0; d < kDim; ++d) Simd::Store(&a[d][(v0 + g) * Simd::kLanes], sum[g][d]);
  }
}

template <int kDim>
void LeverSumsOfLaw(const DriftFactor& factor, const NoiseModel& noise, const ModeData& data,
                    const PredictionTile& tile, const double* log_scale, double (*a)[kTileLanes]) noexcept {
  const NoiseSettings& s = noise.settings();
  switch (s.kind) {
    case NoiseKind::kGaussian: return LeverSums<kDim, NoiseKind::kGaussian>(factor, s, data, tile, log_scale, a);
    case NoiseKind::kLaplace: return LeverSums<kDim, NoiseKind::kLaplace>(factor, s, data, tile, log_scale, a);
    case NoiseKind::kStudentT: return LeverSums<kDim, NoiseKind::kStudentT>(factor, s, data, tile, log_scale, a);
    case NoiseKind::kMixture: return LeverSums<kDim, NoiseKind::kMixture>(factor, s, data, tile, log_scale, a);
  }
}

/// See Kernels::apply_drift.
void ApplyDrift(const DriftFactor& factor, const NoiseModel& noise, const ModeData& data, const PredictionTile& tile,
                const double* log_scale, const double* const* u, int first, double* out) noexcept ARMCMC_NONBLOCKING {
  static_assert(kMaxParams == 8);
  constexpr double kMost = 600.0;  // nats: beyond, the expansion says nothing
  alignas(64) double sums[kMaxParams][kTileLanes];
  const int dim = factor.dim;
  switch (dim) {
    case 1: LeverSumsOfLaw<1>(factor, noise, data, tile, log_scale, sums); break;
    case 2: LeverSumsOfLaw<2>(factor, noise, data, tile, log_scale, sums); break;
    case 3: LeverSumsOfLaw<3>(factor, noise, data, tile, log_scale, sums); break;
    case 4: LeverSumsOfLaw<4>(factor, noise, data, tile, log_scale, sums); break;
    case 5: LeverSumsOfLaw<5>(factor, noise, data, tile, log_scale, sums); break;
    case 6: LeverSumsOfLaw<6>(factor, noise, data, tile, log_scale, sums); break;
    case 7: LeverSumsOfLaw<7>(factor, noise, data, tile, log_scale, sums); break;
    case 8: LeverSumsOfLaw<8>(factor, noise, data, tile, log_scale, sums); break;
    default: return;
  }
  for (int lane = 0; lane < kTileLanes; lane += Simd::kLanes) {
    V apart[kMaxParams], speed[kMaxParams], c[kMaxParams];
    for (int d = 0; d < dim; ++d) apart[d] = Simd::Load(u[d] + first + lane) - Simd::Set(factor.place[d]);
    for (int i = 0; i < dim; ++i) {
      speed[i] = Simd::Set(factor.speed[i]);
      for (int j = 0; j < dim; ++j) speed[i] = Simd::Fma(Simd::Set(factor.regression[i][j]), apart[j], speed[i]);
    }
    // G grows with the precision of the candidate's noise.
    const V finer = Simd::Exp2((Simd::Set(factor.log_scale) - Simd::Load(log_scale + lane)) * Simd::Set(2.0 * kLog2E));
    V log_factor{};
    for (int i = 0; i < dim; ++i) {
      const V a = Simd::Load(&sums[i][lane]);
      V moved{};  // G m
      for (int j = 0; j < dim; ++j) moved = Simd::Fma(Simd::Set(factor.information[i][j]), speed[j], moved);
      moved = moved * finer;
      c[i] = a + moved;
      log_factor = log_factor - speed[i] * Simd::Fma(moved, Simd::Set(0.5), a);
    }
    V determinant = Simd::Set(1.0);
    for (int i = 0; i < dim; ++i) {
      V white{};
      for (int j = 0; j < dim; ++j) white = Simd::Fma(Simd::Set(factor.whiten[i][j]), c[j], white);
      const V shrink = Simd::Fma(Simd::Set(factor.gain[i]), finer, Simd::Set(1.0));
      determinant = determinant * shrink;
      log_factor = Simd::Fma(Simd::Set(0.5) * white, white / shrink, log_factor);
    }
    log_factor = Simd::Fma(Simd::Set(-0.5 * kLn2), Simd::Log2(determinant), log_factor);
    const V held = Simd::Min(Simd::Max(log_factor, Simd::Set(-kMost)), Simd::Set(kMost));
    Simd::Store(out + lane, Simd::Load(out + lane) * Simd::Exp2(held * Simd::Set(kLog2E)));
  }
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
