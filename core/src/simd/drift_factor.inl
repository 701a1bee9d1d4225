// The likelihood of parameters that drift while a pack is recorded; included by kernels.inl, once per instruction set.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// See Kernels::lever_sums.
template <int kDim>
void LeverSums(const DriftFactor& factor, const NoiseModel& noise, const ModeData& data, const PredictionTile& tile,
               const double* log_scale, LeverTile* sums, double* log_likelihood) noexcept {
  constexpr int kGroup = 2;
  const NoiseSettings& s = noise.settings();
  const V mean = Simd::Set(s.mean);
  ForLaw<ScoreSimd, kGroup>(s.kind, [&]<class Law>() noexcept {
    for (int v0 = 0; v0 < kVectors; v0 += kGroup) {
      V inverse[static_cast<unsigned>(kGroup)];
      V sum[static_cast<unsigned>(kGroup)][static_cast<unsigned>(kDim)] = {};
      InverseScale<kGroup>(log_scale + v0 * Simd::kLanes, inverse);
      Law law(s, inverse);
      for (int n0 = 0; n0 < data.num_samples; n0 += kRun) {
        const int end = n0 + kRun < data.num_samples ? n0 + kRun : data.num_samples;
        for (int n = n0; n < end; ++n) {
          const auto k = static_cast<unsigned>(n);
          const V target = Simd::Set(data.target[k]);
          const V weight = Simd::Set(data.weight[k]);
          V error[static_cast<unsigned>(kGroup)], score[static_cast<unsigned>(kGroup)];
          for (int g = 0; g < kGroup; ++g) {
            const V f = Simd::Load(&tile.value[k][static_cast<unsigned>((v0 + g) * Simd::kLanes)]);
            error[g] = (target - f - mean) * weight;
          }
          law.AddWithScore(error, score);
          for (int d = 0; d < kDim; ++d) {
            const V lever = Simd::Set(factor.lever[d][n]);
            for (int g = 0; g < kGroup; ++g) sum[g][d] = Simd::Fma(lever, score[g], sum[g][d]);
          }
        }
        law.EndRun();
      }
      for (int g = 0; g < kGroup; ++g) {
        Simd::Store(log_likelihood + (v0 + g) * Simd::kLanes, law.Result(g));
        for (int d = 0; d < kDim; ++d) Simd::Store(&sums->value[d][(v0 + g) * Simd::kLanes], sum[g][d]);
      }
    }
    AddConstant<Law>(noise, data.num_samples, log_scale, log_likelihood);
  });
}

/// See Kernels::lever_sums.
void LeverSumsOf(const DriftFactor& factor, const NoiseModel& noise, const ModeData& data, const PredictionTile& tile,
                 const double* log_scale, LeverTile* sums, double* log_likelihood) noexcept ARMCMC_NONBLOCKING {
  static_assert(kMaxParams == 8);
  switch (factor.dim) {
    case 1: return LeverSums<1>(factor, noise, data, tile, log_scale, sums, log_likelihood);
    case 2: return LeverSums<2>(factor, noise, data, tile, log_scale, sums, log_likelihood);
    case 3: return LeverSums<3>(factor, noise, data, tile, log_scale, sums, log_likelihood);
    case 4: return LeverSums<4>(factor, noise, data, tile, log_scale, sums, log_likelihood);
    case 5: return LeverSums<5>(factor, noise, data, tile, log_scale, sums, log_likelihood);
    case 6: return LeverSums<6>(factor, noise, data, tile, log_scale, sums, log_likelihood);
    case 7: return LeverSums<7>(factor, noise, data, tile, log_scale, sums, log_likelihood);
    case 8: return LeverSums<8>(factor, noise, data, tile, log_scale, sums, log_likelihood);
    default: return;
  }
}

/// See Kernels::lever_node_sums.
void LeverNodeSums(const DriftFactor& factor, const ModeData& data, int num_linear, const PredictionTile* prediction,
                   double* const* sums) noexcept ARMCMC_NONBLOCKING {
  for (int v = 0; v < kVectors; ++v) {
    const auto lane = static_cast<unsigned>(v * Simd::kLanes);
    V total[QuadraticForm::kMaxFunctions] = {};
    for (int n = 0; n < data.num_samples; ++n) {
      const auto in = static_cast<unsigned>(n);
      V part[static_cast<unsigned>(kMaxParams + 1)];  // the error, and what each parameter takes from it
      part[0] = Simd::Load(&prediction[0].value[in][lane]);
      for (int i = 1; i <= num_linear; ++i) part[i] = -Simd::Load(&prediction[i].value[in][lane]);
      int f = 0;
      for (int d = 0; d < factor.dim; ++d) {
        const V lever = Simd::Set(factor.lever[d][n]);
        for (int i = 0; i <= num_linear; ++i, ++f) total[f] = Simd::Fma(lever, part[i], total[f]);
      }
    }
    for (int f = 0; f < factor.dim * (1 + num_linear); ++f) Simd::Store(sums[f] + lane, total[f]);
  }
}

template <int kDim>
void ApplyDrift(const DriftFactor& factor, const LeverTile& sums, const double* log_scale, const double* const* u,
                int first, double* out) noexcept {
  constexpr double kMost = 600.0;  // nats: beyond, the expansion says nothing
  constexpr auto kSize = static_cast<unsigned>(kDim);
  for (int lane = 0; lane < kTileLanes; lane += Simd::kLanes) {
    V apart[kSize], speed[kSize], c[kSize];
    for (int d = 0; d < kDim; ++d) apart[d] = Simd::Load(u[d] + first + lane) - Simd::Set(factor.place[d]);
    for (int i = 0; i < kDim; ++i) {
      speed[i] = Simd::Set(factor.speed[i]);
      for (int j = 0; j < kDim; ++j) speed[i] = Simd::Fma(Simd::Set(factor.regression[i][j]), apart[j], speed[i]);
    }
    // G grows with the precision of the candidate's noise.
    const V finer = Simd::Exp2((Simd::Set(factor.log_scale) - Simd::Load(log_scale + lane)) * Simd::Set(2.0 * kLog2E));
    V log_factor{};
    for (int i = 0; i < kDim; ++i) {
      const V a = Simd::Load(&sums.value[i][lane]);
      V moved{};  // G m
      for (int j = 0; j < kDim; ++j) moved = Simd::Fma(Simd::Set(factor.information[i][j]), speed[j], moved);
      moved = moved * finer;
      c[i] = a + moved;
      log_factor = log_factor - speed[i] * Simd::Fma(moved, Simd::Set(0.5), a);
    }
    V determinant = Simd::Set(1.0);
    for (int i = 0; i < kDim; ++i) {
      V white{};
      for (int j = 0; j < kDim; ++j) white = Simd::Fma(Simd::Set(factor.whiten[i][j]), c[j], white);
      const V shrink = Simd::Fma(Simd::Set(factor.gain[i]), finer, Simd::Set(1.0));
      determinant = determinant * shrink;
      log_factor = Simd::Fma(Simd::Set(0.5) * white, white / shrink, log_factor);
    }
    log_factor = Simd::Fma(Simd::Set(-0.5 * kLn2), Simd::Log2(determinant), log_factor);
    const V held = Simd::Min(Simd::Max(log_factor, Simd::Set(-kMost)), Simd::Set(kMost));
    Simd::Store(out + lane, Simd::Load(out + lane) * Simd::Exp2(held * Simd::Set(kLog2E)));
  }
}

/// See Kernels::apply_drift.
void ApplyDriftOf(const DriftFactor& factor, const LeverTile& sums, const double* log_scale, const double* const* u,
                  int first, double* out) noexcept ARMCMC_NONBLOCKING {
  static_assert(kMaxParams == 8);
  switch (factor.dim) {
    case 1: return ApplyDrift<1>(factor, sums, log_scale, u, first, out);
    case 2: return ApplyDrift<2>(factor, sums, log_scale, u, first, out);
    case 3: return ApplyDrift<3>(factor, sums, log_scale, u, first, out);
    case 4: return ApplyDrift<4>(factor, sums, log_scale, u, first, out);
    case 5: return ApplyDrift<5>(factor, sums, log_scale, u, first, out);
    case 6: return ApplyDrift<6>(factor, sums, log_scale, u, first, out);
    case 7: return ApplyDrift<7>(factor, sums, log_scale, u, first, out);
    case 8: return ApplyDrift<8>(factor, sums, log_scale, u, first, out);
    default: return;
  }
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
