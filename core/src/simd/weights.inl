// Weights of scored candidates; included by kernels.inl, once per instruction set.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

double LargestInside(const double* value, const double* inside, int count) noexcept ARMCMC_NONBLOCKING {
  const V none = Simd::Set(-HUGE_VAL);
  V largest = none;
  for (int k = 0; k < count; k += Simd::kLanes) {
    const V v = Simd::Load(value + k);
    // v - v is NaN for an infinity and for NaN.
    const Simd::I usable = (Simd::Load(inside + k) > V{}) & (v - v == V{});
    largest = Simd::Max(largest, Simd::Select(usable, v, none));
  }
  double result = -HUGE_VAL;
  for (int l = 0; l < Simd::kLanes; ++l) result = largest[l] > result ? largest[l] : result;
  return result;
}

V PriorFromMemory(const PriorTerms& prior, int k) noexcept {
  const V two = Simd::Fma(Simd::Set(prior.memory_share[1]), Simd::Load(prior.memory[1] + k),
                          Simd::Set(prior.memory_share[0]) * Simd::Load(prior.memory[0] + k));
  return prior.memory_share[2] > 0.0 ? Simd::Fma(Simd::Set(prior.memory_share[2]), Simd::Load(prior.memory[2] + k), two)
                                     : two;
}

void Weigh(const PriorTerms& prior, const double* proposal, int count, double* weight) noexcept ARMCMC_NONBLOCKING {
  for (int k = 0; k < count; k += Simd::kLanes) {
    const V initial = Simd::Load(prior.initial + k);
    const V p = Simd::Fma(Simd::Set(prior.initial_share), initial, PriorFromMemory(prior, k));
    const V q = proposal != nullptr ? Simd::Load(proposal + k) : Simd::Set(1.0);
    const V w = Simd::Load(weight + k) * p / q;
    const Simd::I usable = (initial > V{}) & (w - w == V{});
    Simd::Store(weight + k, Simd::Select(usable, w, V{}));
  }
}

void SharePrior(const PriorTerms& prior, const double* weight, int count, double* first_share,
                double* sums) noexcept ARMCMC_NONBLOCKING {
  Sums<2> s;
  for (int k = 0; k < count; k += 8)
    for (unsigned p = 0; p < Sums<1>::kParts; ++p) {
      const int at = k + static_cast<int>(p) * Simd::kLanes;
      const V fresh = Simd::Set(prior.initial_share) * Simd::Load(prior.initial + at);
      const V total = PriorFromMemory(prior, at) + fresh + Simd::Set(1e-300);
      const V inverse = Simd::Set(1.0) / total;
      const V first = Simd::Set(prior.memory_share[0]) * Simd::Load(prior.memory[0] + at) * inverse;
      const V w = Simd::Load(weight + at);
      Simd::Store(first_share + at, first);
      s.Add(0, p, w * first);
      s.Add(1, p, w * (fresh * inverse));
    }
  for (int i = 0; i < 2; ++i) sums[i] = s.Total(i);
}

int LargestProduct(const double* a, const double* b, int count) noexcept ARMCMC_NONBLOCKING {
  V largest = Simd::Set(-1.0);
  V where = V{};
  V index = V{};
  for (int l = 0; l < Simd::kLanes; ++l) index[l] = l;
  for (int k = 0; k < count; k += Simd::kLanes) {
    const V v = Simd::Load(a + k) * (b != nullptr ? Simd::Load(b + k) : Simd::Set(1.0));
    const Simd::I better = v > largest;
    largest = Simd::Select(better, v, largest);
    where = Simd::Select(better, index, where);
    index = index + Simd::Set(Simd::kLanes);
  }
  int best = 0;
  for (int l = 1; l < Simd::kLanes; ++l)  // the first of equals, as a scan in order finds it
    if (largest[l] > largest[best] || (largest[l] == largest[best] && where[l] < where[best])) best = l;
  return static_cast<int>(where[best]);
}

void Divide(const double* value, double by, int count, double* out) noexcept ARMCMC_NONBLOCKING {
  for (int k = 0; k < count; k += Simd::kLanes) Simd::Store(out + k, Simd::Load(value + k) / Simd::Set(by));
}

void Ratio(const double* a, const double* b, int count, double* out) noexcept ARMCMC_NONBLOCKING {
  for (int k = 0; k < count; k += Simd::kLanes) {
    const V divisor = Simd::Load(b + k);
    Simd::Store(out + k, Simd::Select(divisor > V{}, Simd::Load(a + k) / divisor, V{}));
  }
}

void MoveToEnd(const EndOfPack& end, const double* v, int count, double* u) noexcept ARMCMC_NONBLOCKING {
  const EndOfPack::Line& line = end.line();
  V knot[EndOfPack::kBends];
  V bend[EndOfPack::kBends];
  for (std::size_t j = 0; j < EndOfPack::kBends; ++j) {
    knot[j] = Simd::Set(line.at[j]);
    bend[j] = Simd::Set(line.bend[j]);
  }
  const V constant = Simd::Set(line.constant);
  const V slope = Simd::Set(line.slope);
  const V lower = Simd::Set(line.lower);
  const V upper = Simd::Set(line.upper);
  for (int k = 0; k < count; k += Simd::kLanes) {
    const V at = Simd::Load(v + k);
    V sum = constant + slope * at;
    for (std::size_t j = 0; j < EndOfPack::kBends; ++j) sum += bend[j] * Simd::Max(at, knot[j]);
    Simd::Store(u + k, Simd::Min(Simd::Max(sum, lower), upper));
  }
}

template <int kDim>
[[gnu::always_inline]] inline V Quadratic(const QuadraticControl& control, const double* const* u, int at) noexcept {
  V z[static_cast<unsigned>(kDim)];
  V sum = Simd::Set(control.constant);
  for (int i = 0; i < kDim; ++i) {
    z[i] = Simd::Load(u[i] + at) - Simd::Set(control.centre[i]);
    V slope = Simd::Set(control.slope[i]);
    for (int j = 0; j <= i; ++j) slope = Simd::Fma(Simd::Set(control.curvature[i][j]), z[j], slope);
    sum = Simd::Fma(slope, z[i], sum);
  }
  return sum;
}

template <int kDim>
void TiltOf(const QuadraticControl& control, const double* const* u, const double* log_likelihood, int count,
            double* weight) noexcept {
  const V most = Simd::Set(kMostTilt);
  for (int k = 0; k < count; k += Simd::kLanes) {
    const V apart = Quadratic<kDim>(control, u, k) - Simd::Load(log_likelihood + k);
    const V held = Simd::Min(Simd::Max(apart, -most), most);
    const V w = Simd::Load(weight + k);
    const Simd::I usable = (w > V{}) & (apart - apart == V{});
    Simd::Store(weight + k, Simd::Select(usable, w * Simd::Exp2(held * Simd::Set(kLog2E)), V{}));
  }
}

void Tilt(const QuadraticControl& control, const double* const* u, const double* log_likelihood, int count,
          double* weight) noexcept ARMCMC_NONBLOCKING {
  ForDimension(control.dim, [&]<int kDim>() noexcept { TiltOf<kDim>(control, u, log_likelihood, count, weight); });
}

template <int kDim>
double ReweighOf(const QuadraticControl& control, const double* const* u, const double* g, int count,
                 double* weight) noexcept {
  Sums<1> sum;
  for (int k = 0; k < count; k += 8)
    for (unsigned p = 0; p < Sums<1>::kParts; ++p) {
      const int at = k + static_cast<int>(p) * Simd::kLanes;
      const V inner = Quadratic<kDim>(control, u, at);
      const V factor = Simd::Max(Simd::Fma(-Simd::Load(g + at), inner, Simd::Set(control.most)), V{});
      const V w = Simd::Load(weight + at) * factor;
      Simd::Store(weight + at, w);
      sum.Add(0, p, w);
    }
  return sum.Total(0);
}

double Reweigh(const QuadraticControl& control, const double* const* u, const double* g, int count,
               double* weight) noexcept ARMCMC_NONBLOCKING {
  double sum = 0.0;
  ForDimension(control.dim, [&]<int kDim>() noexcept { sum = ReweighOf<kDim>(control, u, g, count, weight); });
  return sum;
}

/// As many small integers as a vector has lanes.
typedef std::int8_t Bytes __attribute__((vector_size(Simd::kLanes)));

void Choose(const double* pick, const double* bounds, int num_bounds, int count,
            std::int8_t* choice) noexcept ARMCMC_NONBLOCKING {
  for (int k = 0; k < count; k += Simd::kLanes) {
    const V p = Simd::Load(pick + k);
    Simd::I passed{};
    for (int b = 0; b < num_bounds; ++b) passed -= p >= Simd::Set(bounds[b]);
    const Bytes small = __builtin_convertvector(passed, Bytes);
    std::memcpy(choice + k, &small, sizeof small);
  }
}

Kernels::Chosen CountChosen(const std::int8_t* choice, int limit, const double* inside,
                            int count) noexcept ARMCMC_NONBLOCKING {
  Simd::I chosen{}, both{};
  for (int k = 0; k < count; k += Simd::kLanes) {
    Bytes small;
    std::memcpy(&small, choice + k, sizeof small);
    const Simd::I is_chosen = __builtin_convertvector(small, Simd::I) < static_cast<std::int64_t>(limit);
    chosen -= is_chosen;
    both -= is_chosen & (Simd::Load(inside + k) > V{});
  }
  Kernels::Chosen total{};
  for (int l = 0; l < Simd::kLanes; ++l) {
    total.chosen += static_cast<int>(chosen[l]);
    total.inside += static_cast<int>(both[l]);
  }
  return total;
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
