// Sums of squared errors without predictions in memory; included by kernels.inl, once per instruction set.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// A model as the scoring loop sees it: which rows of the ThetaTile it reads, and base + F(x_n, theta). Far(n): the
/// power of a base needs the exact Simd, not ScoreSimd. Where the law has one power, AddPower() takes it as known.
template <class Model>
struct PlainForward {
  static constexpr unsigned kRows = static_cast<unsigned>(Model::kInfo.num_parameters);
  static constexpr int kExponent = Model::kExponent;
  const ModeData& data;
  static Simd::V Load(const ThetaTile& theta, unsigned i, unsigned lane) noexcept {
    return Simd::Load(&theta.value[i][lane]);
  }
  bool Far(int n) const noexcept { return Model::LargestLog2(data, n) > ScoreSimd::kReach; }
  template <class S>
  Simd::V AddTo(Simd::V base, const Simd::V* theta, int n) const noexcept {
    return Model::template AddTo<S>(base, theta, data, n);
  }
  double Log2(int n) const noexcept { return Model::Log2(data, n); }
  Simd::V AddPower(Simd::V base, Simd::V power, const Simd::V* theta, int n) const noexcept {
    return Model::template AddPower<Simd>(base, power, theta, data, n);
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
  // As many as there are registers for: AVX-512 has twice as many of them.
  constexpr int kGroup = Simd::kLanes == 8 && Forward::kRows <= 4 ? 4 : 2;
  for (int v0 = 0; v0 < kVectors; v0 += kGroup) {
    V parameters[static_cast<unsigned>(kGroup)][Forward::kRows];
    V sum[static_cast<unsigned>(kGroup)];
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

/// sum[g] = base + F(x_n, parameters[g]) by ScoreSimd, the powers of all side by side.
template <int kGroup, class Forward>
[[gnu::always_inline]] inline void AddEach(const Forward& forward, V base, const V (*parameters)[Forward::kRows], int n,
                                           V* sum) noexcept {
  if constexpr (Forward::kExponent >= 0) {
    V power[static_cast<unsigned>(kGroup)];
    for (int g = 0; g < kGroup; ++g) power[g] = parameters[g][Forward::kExponent];
    ScoreSimd::PowerEach<kGroup>(power, forward.Log2(n));
    for (int g = 0; g < kGroup; ++g) sum[g] = forward.AddPower(base, power[g], parameters[g], n);
  } else {
    for (int g = 0; g < kGroup; ++g) sum[g] = forward.template AddTo<ScoreSimd>(base, parameters[g], n);
  }
}

/// Errors of a run of `size` samples from n0 on, before their weights: e[i][g] = F - target + mean at sample n0 + i.
struct DirectErrors {
  template <int kGroup, class Forward>
  [[gnu::always_inline]] void Run(const Forward& forward, const ModeData& data, const V (*parameters)[Forward::kRows],
                                  double noise_mean, int n0, int size,
                                  V (*e)[static_cast<unsigned>(kGroup)]) const noexcept {
    for (int i = 0; i < size; ++i) {
      const int n = n0 + i;
      const V minus_target = Simd::Set(noise_mean - data.target[static_cast<unsigned>(n)]);
      if (forward.Far(n)) {
        for (int g = 0; g < kGroup; ++g) e[i][g] = forward.template AddTo<Simd>(minus_target, parameters[g], n);
      } else {
        AddEach<kGroup>(forward, minus_target, parameters, n, e[i]);
      }
    }
  }
};

/// Where both lanes of a vector are not filled by one operation, coefficients are kept twice.
constexpr int kSeriesCopies = Simd::kLanes == 2 ? 2 : 1;

/// The same by polynomials.
template <int kDegree, int kGroup, class Forward>
[[gnu::noinline]] void SeriesErrors(const Forward& forward, const ModeData& data, const PowerSeries& series,
                                    const V (*parameters)[Forward::kRows], double noise_mean, int n0, int size,
                                    V (*e)[static_cast<unsigned>(kGroup)]) noexcept {
  V from_middle[static_cast<unsigned>(kGroup)];
  for (int g = 0; g < kGroup; ++g) from_middle[g] = parameters[g][series.parameter] - Simd::Set(series.middle);
  for (int i = 0; i < size; ++i) {
    const int n = n0 + i;
    const auto coefficient = [&](int k) noexcept {
      const double* const at = &series.coefficient[static_cast<unsigned>(k)][static_cast<unsigned>(kSeriesCopies * n)];
      return kSeriesCopies == Simd::kLanes ? Simd::Load(at) : Simd::Set(*at);
    };
    V power[static_cast<unsigned>(kGroup)];
    const V highest = coefficient(kDegree);
    for (int g = 0; g < kGroup; ++g) power[g] = highest;
    for (int k = kDegree - 1; k >= 0; --k) {
      const V next = coefficient(k);
      for (int g = 0; g < kGroup; ++g) power[g] = Simd::Fma(power[g], from_middle[g], next);
    }
    const V minus_target = Simd::Set(noise_mean - data.target[static_cast<unsigned>(n)]);
    for (int g = 0; g < kGroup; ++g) e[i][g] = forward.AddPower(minus_target, power[g], parameters[g], n);
  }
}

struct NearErrors {
  const PowerSeries& series;

  template <int kGroup, class Forward>
  [[gnu::always_inline]] void Run(const Forward& forward, const ModeData& data, const V (*parameters)[Forward::kRows],
                                  double noise_mean, int n0, int size,
                                  V (*e)[static_cast<unsigned>(kGroup)]) const noexcept {
    const auto by = [&]<int kDegree>(std::integral_constant<int, kDegree>) noexcept {
      SeriesErrors<kDegree, kGroup>(forward, data, series, parameters, noise_mean, n0, size, e);
    };
    switch (series.degree[static_cast<unsigned>(n0 / PowerSeries::kRun)]) {
      case 3: return by(std::integral_constant<int, 3>());
      case 4: return by(std::integral_constant<int, 4>());
      case 5: return by(std::integral_constant<int, 5>());
      case 6: return by(std::integral_constant<int, 6>());
      case 7: return by(std::integral_constant<int, 7>());
      case 8: return by(std::integral_constant<int, 8>());
      default: DirectErrors().Run<kGroup>(forward, data, parameters, noise_mean, n0, size, e);
    }
  }
};

/// Log-likelihood under another law than the Gaussian, without predictions in memory. Errors of a run first, then what
/// the law makes of them: in one loop a sample would be one chain of operations, too long for a processor to begin the
/// next ones in time.
template <class Forward, class Errors>
void ScoreLaw(const Forward& forward, const Errors& errors, const ModeData& data, const ThetaTile& theta,
              const NoiseModel& noise, const double* log_scale, int lanes, double* out) noexcept {
  constexpr int kGroup = 4;
  const NoiseSettings& s = noise.settings();
  ForLaw<ScoreSimd, kGroup>(s.kind, [&]<class Law>() noexcept {
    for (int v0 = 0; v0 * Simd::kLanes < lanes; v0 += kGroup) {
      V inverse_scale[static_cast<unsigned>(kGroup)];
      InverseScale<kGroup>(log_scale + v0 * Simd::kLanes, inverse_scale);
      Law law(s, inverse_scale);
      V parameters[static_cast<unsigned>(kGroup)][Forward::kRows];
      for (int g = 0; g < kGroup; ++g)
        for (unsigned i = 0; i < Forward::kRows; ++i)
          parameters[g][i] = forward.Load(theta, i, static_cast<unsigned>((v0 + g) * Simd::kLanes));
      for (int n0 = 0; n0 < data.num_samples; n0 += kRun) {
        const int size = n0 + kRun < data.num_samples ? kRun : data.num_samples - n0;
        V e[static_cast<unsigned>(kRun)][static_cast<unsigned>(kGroup)];
        errors.template Run<kGroup>(forward, data, parameters, s.mean, n0, size, e);
        if (data.weighted)
          for (int i = 0; i < size; ++i)
            for (int g = 0; g < kGroup; ++g) e[i][g] = e[i][g] * Simd::Set(data.weight[static_cast<unsigned>(n0 + i)]);
        for (int i = 0; i < size; ++i) law.Add(e[i]);
        law.EndRun();
      }
      for (int g = 0; g < kGroup; ++g) Simd::Store(out + (v0 + g) * Simd::kLanes, law.Result(g));
    }
    AddConstant<Law>(noise, data.num_samples, log_scale, out);
  });
}

/// Minimax coefficients of e^x over |x| <= kSeriesReach, by degree from PowerSeries::kLeast on, lowest first.
constexpr double kSeriesReach[PowerSeries::kMost - PowerSeries::kLeast + 1] = {0.00936, 0.0377, 0.0986,
                                                                               0.2,     0.346,  0.537};
constexpr double kSeriesExp[PowerSeries::kMost - PowerSeries::kLeast + 1][PowerSeries::kMost + 1] = {
    {0.99999999996002442, 1.0000000000879468, 0.50000365039067241, 0.16666593660132442},
    {0.99999999999873423, 0.9999999946851782, 0.50000000620229645, 0.16668154912939501, 0.041664186141691359},
    {1.0000000000397276, 0.99999999983489507, 0.49999992627688372, 0.16666672644632174, 0.041686910703036074,
     0.0083304379684583946},
    {1.0000000000069067, 1.0000000013731354, 0.4999999970561233, 0.16666639035418479, 0.041666840114621267,
     0.008347197513521358, 0.0013871525182686916},
    {0.99999999996218625, 1.0000000002398988, 0.50000001035144082, 0.16666665141340872, 0.041666228305970818,
     0.0083335595813436979, 0.0013947989133236956, 0.00019775396744247672},
    {0.99999999998153488, 0.99999999939224626, 0.50000000202244554, 0.16666669597155379, 0.04166663310967398,
     0.0083329574978011009, 0.0013890551281333949, 0.00020018216785890402, 2.4623383447828002e-05}};

/// See Kernels::expand_power.
template <class Model>
void ExpandPowerPlain(const ModeData& data, const double* middle, const double* reach,
                      PowerSeries* series) noexcept ARMCMC_NONBLOCKING {
  constexpr int kMost = PowerSeries::kMost;
  constexpr int kLeast = PowerSeries::kLeast;
  static_assert(PowerSeries::kRun == kRun);
  series->parameter = Model::kExponent;
  if constexpr (Model::kExponent >= 0) {
    series->middle = middle[Model::kExponent];
    series->reach = reach[Model::kExponent];
    for (int n0 = 0; n0 < data.num_samples; n0 += kRun) {
      alignas(64) double log2[static_cast<unsigned>(kRun)] = {};
      double largest = 0.0;
      for (int i = 0; i < kRun && n0 + i < data.num_samples; ++i) {
        log2[i] = Model::Log2(data, n0 + i);
        largest = std::fmax(largest, std::fabs(log2[i]));
      }
      int& degree = series->degree[static_cast<unsigned>(n0 / kRun)];
      degree = kLeast;
      while (degree <= kMost && !(largest * series->reach * kLn2 <= kSeriesReach[degree - kLeast])) ++degree;
      if (degree > kMost || !(largest * std::fabs(series->middle) <= 960.0)) {
        degree = 0;
        continue;
      }
      for (int i = 0; i < kRun; i += Simd::kLanes) {
        const V rate = Simd::Load(log2 + i);
        V factor = Simd::Exp2(rate * Simd::Set(series->middle));
        for (int k = 0; k <= degree; ++k) {
          const V value = factor * Simd::Set(kSeriesExp[degree - kLeast][k]);
          for (int lane = 0; lane < Simd::kLanes; ++lane)
            for (int copy = 0; copy < kSeriesCopies; ++copy)
              series->coefficient[static_cast<unsigned>(k)]
                                 [static_cast<unsigned>(kSeriesCopies * (n0 + i + lane) + copy)] = value[lane];
          factor = factor * (rate * Simd::Set(kLn2));
        }
      }
    }
  }
}

template <class Model>
void ScoreNearPlain(const PowerSeries* series, const ModeData& data, const ThetaTile& theta, const NoiseModel& noise,
                    const double* log_scale, int lanes, double* out) noexcept ARMCMC_NONBLOCKING {
  if constexpr (Model::kExponent >= 0) {
    const PlainForward<Model> forward{data};
    if (series != nullptr) {
      ScoreLaw(forward, NearErrors{*series}, data, theta, noise, log_scale, lanes, out);
    } else {
      ScoreLaw(forward, DirectErrors(), data, theta, noise, log_scale, lanes, out);
    }
  }
}

template <class Model>
void ScoreLawPlain(const ModeData& data, const ThetaTile& theta, const NoiseModel& noise, const double* log_scale,
                   double* out) noexcept ARMCMC_NONBLOCKING {
  ScoreLaw(PlainForward<Model>{data}, DirectErrors(), data, theta, noise, log_scale, kTileLanes, out);
}

template <class Model>
void SumSquaresPlain(const ModeData& data, const ThetaTile& theta, double noise_mean,
                     double* out) noexcept ARMCMC_NONBLOCKING {
  SumSquaresOf(PlainForward<Model>{data}, data, theta, noise_mean, out);
}

/// out[lane] = log-likelihood, see Kernels::score.
using ScoreLawFn = void (*)(const ModeData&, const ThetaTile&, const NoiseModel&, const double* log_scale,
                            double*) noexcept ARMCMC_NONBLOCKING;
/// out[lane] = sum_n (weight_n (target_n - mean - F))^2.
using SumSquaresFn = void (*)(const ModeData&, const ThetaTile&, double, double*) noexcept ARMCMC_NONBLOCKING;

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
