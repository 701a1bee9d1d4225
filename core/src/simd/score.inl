// Log-likelihood of candidates without their predictions in memory; included by kernels.inl, once per instruction set.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// A model as the scoring loop sees it: which rows of the ThetaTile it reads, and base + F(x_n, theta).
template <class Model>
struct PlainForward {
  static constexpr unsigned kRows = static_cast<unsigned>(Model::kInfo.num_parameters);
  const ModeData& data;
  static Simd::V Load(const ThetaTile& theta, unsigned i, unsigned lane) noexcept {
    return Simd::Load(&theta.value[i][lane]);
  }
  bool Far(int n) const noexcept { return Model::LargestLog2(data, n) > ScoreSimd::kReach; }
  template <class S>
  Simd::V AddTo(Simd::V base, const Simd::V* theta, int n) const noexcept {
    return Model::template AddTo<S>(base, theta, data, n);
  }
};

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

/// The valve flow with effects, but for slow valves.
struct FlowForward {
  static constexpr unsigned kRows = kFlowRows;
  const ModeData& data;
  static bool Far(int) noexcept { return false; }
  template <class S>
  Simd::V AddTo(Simd::V base, const Simd::V* theta, int k) const noexcept {
    const auto n = static_cast<std::size_t>(data.sample[static_cast<unsigned>(k)]);
    return base + FlowRate(*data.flow, data.mode, theta, Simd::Set(Command(*data.flow, n)), n);
  }
  Simd::V Load(const ThetaTile& theta, unsigned i, unsigned lane) const noexcept {
    return FlowRow(*data.flow, theta, i, lane);
  }
};

/// sum[g] += (weight_n (target_n - mean - F))^2 at sample n.
template <class S, bool kWeighted, int kGroup, class Forward>
void AddSquares(const Forward& forward, const ModeData& data, const V (*parameters)[Forward::kRows], double noise_mean,
                int n, V* sum) noexcept {
  const auto in = static_cast<unsigned>(n);
  const V minus_target = Simd::Set(noise_mean - data.target[in]);
  for (int g = 0; g < kGroup; ++g) {
    V e = forward.template AddTo<S>(minus_target, parameters[g], n);
    if constexpr (kWeighted) e = e * Simd::Set(data.weight[in]);
    sum[g] = Simd::Fma(e, e, sum[g]);
  }
}

/// out[lane] = sum_n (weight_n (target_n - mean - F))^2. Several vectors advance together, so that the chain of
/// operations of one does not keep the arithmetic units waiting.
template <bool kWeighted, class Forward>
void SumSquares(const Forward& forward, const ModeData& data, const ThetaTile& theta, double noise_mean,
                double* out) noexcept {
  constexpr int kGroup = 2;  // more would need more registers than there are
  for (int v0 = 0; v0 < kVectors; v0 += kGroup) {
    V parameters[kGroup][Forward::kRows];
    V sum[kGroup];
    for (int g = 0; g < kGroup; ++g) {
      const auto lane = static_cast<unsigned>((v0 + g) * Simd::kLanes);
      for (unsigned i = 0; i < Forward::kRows; ++i) parameters[g][i] = forward.Load(theta, i, lane);
      sum[g] = V{};
    }
    for (int n = 0; n < data.num_samples; ++n) {
      if (forward.Far(n)) {
        AddSquares<Simd, kWeighted, kGroup>(forward, data, parameters, noise_mean, n, sum);
      } else {
        AddSquares<ScoreSimd, kWeighted, kGroup>(forward, data, parameters, noise_mean, n, sum);
      }
    }
    for (int g = 0; g < kGroup; ++g) Simd::Store(out + (v0 + g) * Simd::kLanes, sum[g]);
  }
}

template <class Forward>
void SumSquaresOf(const Forward& forward, const ModeData& data, const ThetaTile& theta, double noise_mean,
                  double* out) noexcept {
  if (data.weighted) {
    SumSquares<true>(forward, data, theta, noise_mean, out);
  } else {
    SumSquares<false>(forward, data, theta, noise_mean, out);
  }
}

void SumSquaresFlow(const ModeData& data, const ThetaTile& theta, double noise_mean,
                    double* out) noexcept ARMCMC_NONBLOCKING {
  SumSquaresOf(FlowForward{data}, data, theta, noise_mean, out);
}

template <unsigned kAdditive>
void SumSquaresAdditive(const ModeData& data, const ThetaTile& theta, double noise_mean,
                        double* out) noexcept ARMCMC_NONBLOCKING {
  SumSquaresOf(AdditiveForward<kAdditive>{*data.contact}, data, theta, noise_mean, out);
}

template <class Model>
void SumSquaresPlain(const ModeData& data, const ThetaTile& theta, double noise_mean,
                     double* out) noexcept ARMCMC_NONBLOCKING {
  SumSquaresOf(PlainForward<Model>{data}, data, theta, noise_mean, out);
}

using SumSquaresFn = void (*)(const ModeData&, const ThetaTile&, double, double*) noexcept ARMCMC_NONBLOCKING;

template <class List>
struct SumSquaresTable;
template <class... Models>
struct SumSquaresTable<ModelList<Models...>> {
  static constexpr SumSquaresFn kOf[] = {&SumSquaresPlain<Models>...};
};
constexpr SumSquaresFn kSumSquaresAdditive[] = {&SumSquaresAdditive<0>, &SumSquaresAdditive<1>, &SumSquaresAdditive<2>,
                                                &SumSquaresAdditive<3>, &SumSquaresAdditive<4>, &SumSquaresAdditive<5>};
static_assert(std::size(kSumSquaresAdditive) == kMaxAdditive + 1);

void Score(int model, const NoiseModel& noise, const ModeData& data, const ThetaTile& theta, const double* log_scale,
           PredictionTile* scratch, double* out) noexcept ARMCMC_NONBLOCKING {
  const bool gaussian = noise.settings().kind == NoiseKind::kGaussian;
  if (!gaussian || (data.flow != nullptr && !ValvesAreFast(*data.flow)) ||
      (data.contact != nullptr && !data.contact->additive_only()) ||
      (data.tape != nullptr && noise.settings().mean != 0.0)) {
    Predict(model, data, theta, scratch);
    LogLikelihood(noise, data, *scratch, log_scale, out);
    return;
  }
  const SumSquaresFn sum_squares = data.contact != nullptr ? kSumSquaresAdditive[data.contact->num_additive]
                                   : data.flow != nullptr  ? &SumSquaresFlow
                                   : data.tape != nullptr  ? &SumSquaresTape
                                                           : SumSquaresTable<AllModels>::kOf[model];
  sum_squares(data, theta, noise.settings().mean, out);
  const V samples = Simd::Set(static_cast<double>(data.num_samples));
  const V constant = Simd::Set(noise.log_constant());
  for (int lane = 0; lane < kTileLanes; lane += Simd::kLanes) {
    const V log_s = Simd::Load(log_scale + lane);
    const V precision = Simd::Exp2(log_s * Simd::Set(-2.0 * kLog2E));
    Simd::Store(out + lane,
                Simd::Fma(Simd::Set(-0.5) * precision, Simd::Load(out + lane), samples * (constant - log_s)));
  }
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
