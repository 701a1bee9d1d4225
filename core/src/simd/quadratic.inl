// Squared errors of laws that are linear in some parameters; included by kernels.inl, once per instruction set.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

void QuadraticSums(const ModeData& data, double noise_mean, int num_linear, PredictionTile* prediction,
                   double* const* sums) noexcept ARMCMC_NONBLOCKING {
  for (int v = 0; v < kVectors; ++v) {
    const auto lane = static_cast<unsigned>(v * Simd::kLanes);
    V total[QuadraticForm::kMaxFunctions] = {};
    for (int n = 0; n < data.num_samples; ++n) {
      const auto in = static_cast<unsigned>(n);
      const V weight = Simd::Set(data.weight[in]);
      const V law = Simd::Load(&prediction[0].value[in][lane]);
      const V error = (Simd::Set(data.target[in] - noise_mean) - law) * weight;
      V slope[static_cast<unsigned>(kMaxParams)];
      for (int i = 0; i < num_linear; ++i) slope[i] = (Simd::Load(&prediction[1 + i].value[in][lane]) - law) * weight;
      Simd::Store(&prediction[0].value[in][lane], error);
      for (int i = 0; i < num_linear; ++i) Simd::Store(&prediction[1 + i].value[in][lane], slope[i]);
      int f = 0;
      total[f] = Simd::Fma(error, error, total[f]);
      for (int i = 0; i < num_linear; ++i) {
        ++f;
        total[f] = Simd::Fma(error, slope[i], total[f]);
        for (int j = i; j < num_linear; ++j) {
          ++f;
          total[f] = Simd::Fma(slope[i], slope[j], total[f]);
        }
      }
    }
    // (e - sum_i d_i s_i)^2: every product of two is there twice.
    int f = 0;
    Simd::Store(sums[f] + lane, total[f]);
    for (int i = 0; i < num_linear; ++i) {
      ++f;
      Simd::Store(sums[f] + lane, Simd::Set(-2.0) * total[f]);
      for (int j = i; j < num_linear; ++j) {
        ++f;
        Simd::Store(sums[f] + lane, i == j ? total[f] : Simd::Set(2.0) * total[f]);
      }
    }
  }
}

/// Several vectors side by side: with one, the arithmetic units would wait.
constexpr int kQuadraticGroup = 4;

void QuadraticProducts(int num_samples, const PredictionTile& rows, const PredictionTile& columns, double factor,
                       double* sums) noexcept ARMCMC_NONBLOCKING {
  constexpr int kRows = 2;
  for (int row = 0; row < kTileLanes; row += kRows)
    for (int v0 = 0; v0 < kVectors; v0 += kQuadraticGroup) {
      const auto lane = static_cast<unsigned>(v0 * Simd::kLanes);
      V total[kRows][static_cast<unsigned>(kQuadraticGroup)] = {};
      for (int n = 0; n < num_samples; ++n) {
        const double* const of_row = &rows.value[static_cast<unsigned>(n)][static_cast<unsigned>(row)];
        const double* const of_column = &columns.value[static_cast<unsigned>(n)][lane];
        for (int g = 0; g < kQuadraticGroup; ++g) {
          const V column = Simd::Load(of_column + g * Simd::kLanes);
          for (int r = 0; r < kRows; ++r) total[r][g] = Simd::Fma(Simd::Set(of_row[r]), column, total[r][g]);
        }
      }
      for (int r = 0; r < kRows; ++r)
        for (int g = 0; g < kQuadraticGroup; ++g)
          Simd::Store(sums + (row + r) * kTileLanes + v0 * Simd::kLanes + g * Simd::kLanes,
                      Simd::Set(factor) * total[r][g]);
    }
}

struct QuadraticVectors {
  V at[static_cast<unsigned>(kQuadraticGroup)];
};

/// Chebyshev polynomials T_0 .. T_degree of t.
struct ChebyshevBasis {
  QuadraticVectors power[QuadraticForm::kMaxDegree + 1];

  void Fill(const QuadraticVectors& t, int degree) noexcept {
    for (int g = 0; g < kQuadraticGroup; ++g) {
      power[0].at[g] = Simd::Set(1.0);
      power[1].at[g] = t.at[g];
    }
    for (int k = 2; k <= degree; ++k)
      for (int g = 0; g < kQuadraticGroup; ++g)
        power[k].at[g] = Simd::Fma(t.at[g] + t.at[g], power[k - 1].at[g], -power[k - 2].at[g]);
  }
  /// sum_k coefficient_k T_k, even and odd terms by themselves. @pre degree is odd.
  [[gnu::always_inline]] QuadraticVectors Sum(const double* coefficient, int degree) const noexcept {
    QuadraticVectors even, odd;
    for (int g = 0; g < kQuadraticGroup; ++g) even.at[g] = odd.at[g] = V{};
    for (int k = 0; k < degree; k += 2)
      for (int g = 0; g < kQuadraticGroup; ++g) {
        even.at[g] = Simd::Fma(power[k].at[g], Simd::Set(coefficient[k]), even.at[g]);
        odd.at[g] = Simd::Fma(power[k + 1].at[g], Simd::Set(coefficient[k + 1]), odd.at[g]);
      }
    for (int g = 0; g < kQuadraticGroup; ++g) even.at[g] = even.at[g] + odd.at[g];
    return even;
  }
};

/// Of every t of the form. @param coordinate  Vector g of u_d of the candidates.
template <class Coordinate>
[[gnu::always_inline]] inline void FillBases(const QuadraticForm& form, const Coordinate& coordinate,
                                             ChebyshevBasis* basis) noexcept {
  for (int a = 0; a < form.num_curved; ++a) {
    const QuadraticForm::Axis& axis = form.axis[static_cast<unsigned>(a)];
    QuadraticVectors t;
    for (int g = 0; g < kQuadraticGroup; ++g) {
      const V place = Simd::Fma(coordinate(axis.parameter, g), Simd::Set(axis.slope), Simd::Set(axis.origin));
      t.at[g] = Simd::Min(Simd::Max(place, Simd::Set(-1.0)), Simd::Set(1.0));
    }
    basis[a].Fill(t, axis.degree);
  }
}

/// A function of a QuadraticForm that needs both of the curved parameters.
QuadraticVectors SumOfProducts(const ProductSeries& series, const ChebyshevBasis* basis) noexcept {
  QuadraticVectors sum;
  for (int g = 0; g < kQuadraticGroup; ++g) sum.at[g] = V{};
  for (unsigned k = 0; k < static_cast<unsigned>(series.num_rows); ++k) {
    const QuadraticVectors row = basis[1].Sum(series.coefficient[k].data(), series.degree[k]);
    for (int g = 0; g < kQuadraticGroup; ++g) sum.at[g] = Simd::Fma(row.at[g], basis[0].power[k].at[g], sum.at[g]);
  }
  return sum;
}

void ScoreQuadratic(const QuadraticForm& form, const ParameterSpace& space, const NoiseModel& noise, int num_samples,
                    const double* const* u, int first, double* out) noexcept ARMCMC_NONBLOCKING {
  const V samples = Simd::Set(static_cast<double>(num_samples));
  const V constant = Simd::Set(noise.log_constant());
  for (int v0 = 0; v0 < kVectors; v0 += kQuadraticGroup) {
    const int lane = v0 * Simd::kLanes;
    const auto coordinate = [&](int d, int g) noexcept { return Simd::Load(u[d] + first + lane + g * Simd::kLanes); };
    ChebyshevBasis basis[static_cast<unsigned>(QuadraticForm::kMaxCurved)];
    FillBases(form, coordinate, basis);
    const ProductSeries* product = form.product.data();
    const auto function = [&](int f) noexcept {
      const auto i = static_cast<unsigned>(f);
      const double* const coefficient = form.coefficient[i].data();
      switch (form.needs[i]) {
        case LinearPart::kCurved: return basis[0].Sum(coefficient, form.degree[i]);
        case LinearPart::kSecond: return basis[1].Sum(coefficient, form.degree[i]);
        case LinearPart::kBoth: return SumOfProducts(*product++, basis);
        case LinearPart::kNeither: break;
      }
      QuadraticVectors value;
      for (int g = 0; g < kQuadraticGroup; ++g) value.at[g] = Simd::Set(coefficient[0]);
      return value;
    };
    int f = 0;
    QuadraticVectors sum = function(f);
    QuadraticVectors d[static_cast<unsigned>(kMaxParams)];
    for (int i = 0; i < form.num_linear; ++i)
      for (int g = 0; g < kQuadraticGroup; ++g)
        d[i].at[g] = coordinate(form.linear[static_cast<unsigned>(i)], g) -
                     Simd::Set(form.about[static_cast<unsigned>(form.linear[static_cast<unsigned>(i)])]);
    for (int i = 0; i < form.num_linear; ++i) {
      QuadraticVectors inner = function(++f);
      for (int j = i; j < form.num_linear; ++j) {
        const QuadraticVectors a = function(++f);
        for (int g = 0; g < kQuadraticGroup; ++g) inner.at[g] = Simd::Fma(a.at[g], d[j].at[g], inner.at[g]);
      }
      for (int g = 0; g < kQuadraticGroup; ++g) sum.at[g] = Simd::Fma(inner.at[g], d[i].at[g], sum.at[g]);
    }
    for (int g = 0; g < kQuadraticGroup; ++g) {
      const V log_s =
          space.samples_noise_scale()
              ? Simd::Fma(Simd::Set(space.scale[static_cast<unsigned>(space.dim - 1)]), coordinate(space.dim - 1, g),
                          Simd::Set(space.offset[static_cast<unsigned>(space.dim - 1)]))
              : Simd::Set(space.log_noise_scale);
      const V precision = Simd::Exp2(log_s * Simd::Set(-2.0 * kLog2E));
      Simd::Store(out + lane + g * Simd::kLanes,
                  Simd::Fma(Simd::Set(-0.5) * precision, sum.at[g], samples * (constant - log_s)));
    }
  }
}

/// See Kernels::levers_quadratic.
void LeversQuadratic(const QuadraticForm& form, const ParameterSpace& space, const double* const* u, int first,
                     LeverTile* sums) noexcept ARMCMC_NONBLOCKING {
  for (int v0 = 0; v0 < kVectors; v0 += kQuadraticGroup) {
    const int lane = v0 * Simd::kLanes;
    const auto coordinate = [&](int d, int g) noexcept { return Simd::Load(u[d] + first + lane + g * Simd::kLanes); };
    ChebyshevBasis basis[static_cast<unsigned>(QuadraticForm::kMaxCurved)];
    FillBases(form, coordinate, basis);
    QuadraticVectors precision;
    for (int g = 0; g < kQuadraticGroup; ++g) {
      const V log_s =
          space.samples_noise_scale()
              ? Simd::Fma(Simd::Set(space.scale[static_cast<unsigned>(space.dim - 1)]), coordinate(space.dim - 1, g),
                          Simd::Set(space.offset[static_cast<unsigned>(space.dim - 1)]))
              : Simd::Set(space.log_noise_scale);
      precision.at[g] = Simd::Exp2(log_s * Simd::Set(-2.0 * kLog2E));
    }
    unsigned f = 0;
    for (int m = 0; m < form.num_levers; ++m) {
      QuadraticVectors sum;
      for (int i = 0; i <= form.num_linear; ++i, ++f) {
        QuadraticVectors value;
        const LinearPart::Need need = form.lever_needs[static_cast<unsigned>(i)];
        if (need == LinearPart::kNeither) {
          for (int g = 0; g < kQuadraticGroup; ++g) value.at[g] = Simd::Set(form.lever[f][0]);
        } else {
          const unsigned a = need == LinearPart::kCurved ? 0 : 1;
          value = basis[a].Sum(form.lever[f].data(), form.axis[a].degree);
        }
        if (i == 0) {
          sum = value;
          continue;
        }
        const int d = form.linear[static_cast<unsigned>(i - 1)];
        for (int g = 0; g < kQuadraticGroup; ++g)
          sum.at[g] =
              Simd::Fma(value.at[g], coordinate(d, g) - Simd::Set(form.about[static_cast<unsigned>(d)]), sum.at[g]);
      }
      for (int g = 0; g < kQuadraticGroup; ++g)
        Simd::Store(&sums->value[m][lane + g * Simd::kLanes], sum.at[g] * precision.at[g]);
    }
  }
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
