#include "armcmc/quadratic_score.hpp"

#include <algorithm>
#include <cmath>

#include "simd/kernels.hpp"

namespace armcmc {
namespace {

/// Nats: the bound applies within a standard deviation of the prior, not to distant candidates.
constexpr double kConfirmed = 1e-4;
constexpr double kPi = 3.14159265358979323846;
constexpr double kRounding = 4e-16;  ///< Of a sum, relative to the sum of the sizes of its terms.

/// Of a sum over the samples of a pack, one after the other: they are at most 256.
constexpr double kSumRounding = 1e-15;
constexpr double kRootOfLanes = 5.6568542494923806;  ///< sqrt(kTileLanes).
static_assert(kTileLanes == 32);

/// Shares of the tolerance: a grid has many more coefficients that are left out.
constexpr int PartsOf(LinearPart::Need needs) noexcept {
  if (needs == LinearPart::kNeither) return 0;
  return needs == LinearPart::kBoth ? 4 : 1;
}

/// fn(f, i, j) of every function of a QuadraticForm, in their order: function f is made of what i and j stand for, 0
/// for the error and 1 + k for what linear[k] changes.
template <class Fn>
void ForFunctions(int num_linear, const Fn& fn) noexcept(noexcept(fn(std::size_t{}, 0, 0))) {
  std::size_t f = 0;
  fn(f, 0, 0);
  for (int i = 1; i <= num_linear; ++i) {
    fn(++f, 0, i);
    for (int j = i; j <= num_linear; ++j) fn(++f, i, j);
  }
}

/// out = (table in)^T.
template <class Table, class Grid>
void TransformColumns(const Table& table, const Grid& in, Grid* out) noexcept {
  for (std::size_t k = 0; k < in.size(); ++k) {
    typename Grid::value_type row{};
    for (std::size_t j = 0; j < in.size(); ++j)
      for (std::size_t l = 0; l < row.size(); ++l) row[l] += table[k][j] * in[j][l];
    for (std::size_t l = 0; l < row.size(); ++l) (*out)[l][k] = row[l];
  }
}

}  // namespace

QuadraticScore::QuadraticScore(const simd::Kernels& kernels, int model, const ParameterSpace& space,
                               const NoiseModel& noise, const LinearPart& part)
    : kernels_(kernels),
      model_(model),
      space_(space),
      noise_(noise),
      part_(part),
      applies_(part.num_linear > 0 && noise.kind() == NoiseKind::kGaussian) {
  if (!applies_) return;
  form_.num_linear = part.num_linear;
  form_.linear = part.linear;
  for (const int d : {part.curved, part.second}) {
    if (d < 0) continue;
    const auto c = static_cast<std::size_t>(d);
    QuadraticForm::Axis& axis = form_.axis[static_cast<std::size_t>(form_.num_curved++)];
    axis.parameter = d;
    axis.slope = 2.0 / (space.upper[c] - space.lower[c]);
    axis.origin = -1.0 - axis.slope * space.lower[c];
  }
  std::size_t products = 0;
  ForFunctions(part.num_linear, [&](std::size_t f, int i, int j) {
    form_.needs[f] = static_cast<LinearPart::Need>(part.NeedOf(i) | part.NeedOf(j));
    products += form_.needs[f] == LinearPart::kBoth ? 1U : 0U;
  });
  if (products > kMaxProducts) applies_ = false;
  if (!applies_ || form_.num_curved == 0) return;
  form_.product.resize(products);
  if (products > 0) grid_.resize(products + 1);
  nodes_ = part.second < 0 ? kNodes : kTileLanes;
  transform_ = nodes_ == kNodes ? &Cosines<kNodes>() : &Cosines<kTileLanes>();
}

template <int kPoints>
const QuadraticScore::CosineTable& QuadraticScore::Cosines() {
  static const CosineTable table = [] {
    CosineTable t{};
    for (int k = 0; k < kPoints; ++k)
      for (int j = 0; j < kPoints; ++j)
        t[static_cast<std::size_t>(k)][static_cast<std::size_t>(j)] =
            (k == 0 ? 1.0 : 2.0) / kPoints * std::cos(kPi * k * (j + 0.5) / kPoints);
    return t;
  }();
  return table;
}

void QuadraticScore::AccumulateSums(const ModeData& data, QuadraticScratch* scratch) noexcept {
  const auto tiles = static_cast<std::size_t>(part_.num_linear) + 1;
  for (int first = 0; first < nodes_; first += kTileLanes) {
    ThetaTile& theta = scratch->theta;
    for (int d = 0; d < space_.num_parameters; ++d)
      theta.value[static_cast<std::size_t>(d)].fill(space_.Theta(d, form_.about[static_cast<std::size_t>(d)]));
    for (int a = 0; a < form_.num_curved; ++a) {
      const QuadraticForm::Axis& axis = form_.axis[static_cast<std::size_t>(a)];
      for (std::size_t l = 0; l < kTileLanes; ++l) {
        const double angle = kPi * (first + static_cast<double>(l) + 0.5) / nodes_;
        const double u = (std::cos(angle) - axis.origin) / axis.slope;
        theta.value[static_cast<std::size_t>(axis.parameter)][l] = space_.Theta(axis.parameter, u);
      }
    }
    for (std::size_t i = 0; i < tiles; ++i) {
      if (i == 0) {
        kernels_.predict(model_, data, theta, &scratch->prediction[0]);
        continue;
      }
      const auto d = static_cast<std::size_t>(part_.linear[i - 1]);
      const double at = theta.value[d][0];
      theta.value[d].fill(at + space_.scale[d]);
      kernels_.predict(model_, data, theta, &scratch->prediction[i]);
      theta.value[d].fill(at);
    }
    std::array<double*, QuadraticForm::kMaxFunctions> rows{};
    for (std::size_t f = 0; f < rows.size(); ++f) rows[f] = &scratch->sums[f][static_cast<std::size_t>(first)];
    kernels_.quadratic_sums(data, noise_.settings().mean, part_.num_linear, scratch->prediction.data(), rows.data());
  }
}

void QuadraticScore::TabulateProducts(const QuadraticScratch& scratch) noexcept {
  std::size_t product = 0;
  ForFunctions(part_.num_linear, [&](std::size_t f, int i, int j) noexcept ARMCMC_NONBLOCKING {
    if (form_.needs[f] != LinearPart::kBoth) return;
    const bool in_order = part_.NeedOf(i) == LinearPart::kCurved;
    const auto row = static_cast<std::size_t>(in_order ? i : j);
    const auto column = static_cast<std::size_t>(in_order ? j : i);
    kernels_.quadratic_products(num_samples_, scratch.prediction[row], scratch.prediction[column],
                                i == 0 ? -2.0 : 2.0,  // every product of two is there twice
                                grid_[product++][0].data());
  });
}

int QuadraticScore::Degree(const Lines& lines, double variance) const noexcept {
  const int functions = QuadraticForm::Functions(part_.num_linear);
  const double tolerance = 2.0 * variance * kTolerance;
  double rest = 0.0;
  for (int f = 0; f < functions; ++f) {
    const auto& series = lines[static_cast<std::size_t>(f)];
    double sum = 0.0;
    for (const double c : series) sum += std::fabs(c);
    rest += kRounding * sum;
    for (std::size_t k = QuadraticForm::kMaxDegree + 1; k < kNodes; ++k) rest += std::fabs(series[k]);
  }
  if (!(rest <= tolerance)) return -1;
  int degree = QuadraticForm::kMaxDegree;
  for (; degree > 1; degree -= 2) {
    for (int f = 0; f < functions; ++f)
      for (const int k : {degree, degree - 1})
        rest += std::fabs(lines[static_cast<std::size_t>(f)][static_cast<std::size_t>(k)]);
    if (!(rest <= tolerance)) break;
  }
  return degree;
}

bool QuadraticScore::EndSeries(const Lines& lines, std::size_t f, double floor, double tolerance) noexcept {
  constexpr int kMost = ProductSeries::kMaxDegree;
  const auto& series = lines[f];
  const auto size = [&](std::size_t k) noexcept { return std::fmax(std::fabs(series[k]) - floor, 0.0); };
  double rest = 0.0;
  for (std::size_t k = kMost + 1; k < kTileLanes; ++k) rest += size(k);
  if (!(rest <= tolerance)) return false;
  int& degree = form_.degree[f];
  for (degree = kMost; degree > 1; degree -= 2) {
    const auto k = static_cast<std::size_t>(degree);
    rest += size(k) + size(k - 1);
    if (!(rest <= tolerance)) break;
  }
  std::copy_n(series.begin(), degree + 1, form_.coefficient[f].begin());
  return true;
}

bool QuadraticScore::EndProduct(const Grid& series, double floor, double tolerance, ProductSeries* out) noexcept {
  constexpr int kMost = ProductSeries::kMaxDegree;
  std::array<double, 2 * kTileLanes - 1> of_degree{};  // k + l
  for (std::size_t k = 0; k < kTileLanes; ++k)
    for (std::size_t l = 0; l < kTileLanes; ++l) of_degree[k + l] += std::fmax(std::fabs(series[k][l]) - floor, 0.0);
  double rest = 0.0;
  for (std::size_t d = kMost + 1; d < of_degree.size(); ++d) rest += of_degree[d];
  if (!(rest <= tolerance)) return false;
  int degree = kMost;
  for (; degree > 1; --degree) {
    rest += of_degree[static_cast<std::size_t>(degree)];
    if (!(rest <= tolerance)) break;
  }
  out->num_rows = degree + 1;
  for (int k = 0; k <= degree; ++k) {
    const auto row = static_cast<std::size_t>(k);
    out->degree[row] = (degree - k) | 1;
    std::copy_n(series[row].begin(), out->degree[row] + 1, out->coefficient[row].begin());
  }
  return true;
}

bool QuadraticScore::EndEach(const Lines& lines, double variance, const ParamVector& centre) noexcept {
  std::array<double, kMaxParams + 1> size{1.0};  // of what stands before a function, within a standard deviation
  for (int i = 0; i < part_.num_linear; ++i) {
    const int d = part_.linear[static_cast<std::size_t>(i)];
    size[static_cast<std::size_t>(i) + 1] = 1.0 + std::fabs(centre[d] - form_.about[static_cast<std::size_t>(d)]);
  }
  const auto size_of = [&](int i, int j) noexcept ARMCMC_NONBLOCKING {
    return size[static_cast<std::size_t>(i)] * size[static_cast<std::size_t>(j)];
  };
  std::array<double, QuadraticForm::kMaxFunctions> sum{};
  double rounding = 0.0;
  int parts = 0;
  std::size_t product = 0;
  ForFunctions(part_.num_linear, [&](std::size_t f, int i, int j) noexcept ARMCMC_NONBLOCKING {
    if (form_.needs[f] == LinearPart::kBoth) {
      for (const auto& row : grid_[product])
        for (const double c : row) sum[f] += std::fabs(c);
      ++product;
    } else {
      for (std::size_t k = 0; k < kTileLanes; ++k) sum[f] += std::fabs(lines[f][k]);
    }
    rounding += kSumRounding * sum[f] * size_of(i, j);
    parts += PartsOf(form_.needs[f]);
  });
  const double tolerance = (2.0 * variance * kTolerance - rounding) / parts;
  if (!(tolerance > 0.0)) return false;
  bool settled = true;
  product = 0;
  for (QuadraticForm::Axis& axis : form_.axis) axis.degree = 1;
  const auto raise = [&](int axis, int degree) noexcept ARMCMC_NONBLOCKING {
    int& largest = form_.axis[static_cast<std::size_t>(axis)].degree;
    largest = std::max(largest, degree);
  };
  ForFunctions(part_.num_linear, [&](std::size_t f, int i, int j) noexcept ARMCMC_NONBLOCKING {
    const double of_series = PartsOf(form_.needs[f]) * tolerance / size_of(i, j);
    // Rounding of the sums alone makes this much of a coefficient: one that is not larger counts as none.
    const double floor = kSumRounding * sum[f] / (form_.needs[f] == LinearPart::kBoth ? kTileLanes : kRootOfLanes);
    switch (form_.needs[f]) {
      case LinearPart::kNeither: form_.coefficient[f][0] = lines[f][0]; break;
      case LinearPart::kCurved:
      case LinearPart::kSecond:
        settled = EndSeries(lines, f, floor, of_series) && settled;
        raise(form_.needs[f] == LinearPart::kCurved ? 0 : 1, form_.degree[f]);
        break;
      case LinearPart::kBoth: {
        ProductSeries& series = form_.product[product];
        settled = EndProduct(grid_[product++], floor, of_series, &series) && settled;
        raise(0, series.num_rows - 1);
        raise(1, series.degree[0]);
        break;
      }
    }
  });
  return settled;
}

bool QuadraticScore::IsConfirmed(const ModeData& data, const ParamVector& centre, const ParamVector& sd,
                                 QuadraticScratch* scratch) const noexcept {
  constexpr int kNear = kTileLanes / 2 - 1;  // odd, so that the centre is one of them
  constexpr double kReach = 4.0;             // standard deviations
  alignas(64) std::array<std::array<double, kTileLanes>, kMaxParams> rows;
  std::array<const double*, kMaxParams> u{};
  for (int d = 0; d < space_.dim; ++d) {
    const auto i = static_cast<std::size_t>(d);
    u[i] = rows[i].data();
    for (int l = 0; l < kTileLanes; ++l) {
      const double side = (l + d) % 2 == 0 ? 1.0 : -1.0;
      double x = centre[d] + side * sd[d];
      const bool curved = d == part_.curved || d == part_.second;
      const bool second = d == part_.second;
      if (curved && l < kNear) {
        const int at = second ? (4 * l + 9) % kNear : l;  // in another order, and 7 is where it was
        x = centre[d] + sd[d] * kReach * (2.0 * at / (kNear - 1) - 1.0);
      } else if (curved) {  // between the points, at unrelated places
        const int at = second ? 4 * (l - kNear) % (kTileLanes - kNear) : l - kNear;
        const double part = (at + 0.61803398874989485) / (kTileLanes - kNear);
        x = space_.lower[i] + part * (space_.upper[i] - space_.lower[i]);
      }
      rows[i][static_cast<std::size_t>(l)] = std::clamp(x, space_.lower[i], space_.upper[i]);
    }
  }
  alignas(64) std::array<double, kTileLanes> log_scale, by_samples, by_sums;
  kernels_.to_physical(space_, u.data(), 0, &scratch->theta, log_scale.data());
  kernels_.predict(model_, data, scratch->theta, &scratch->prediction[0]);
  kernels_.log_likelihood(noise_, data, scratch->prediction[0], log_scale.data(), by_samples.data());
  Score(u.data(), 0, by_sums.data());
  for (std::size_t l = 0; l < kTileLanes; ++l)
    if (!(std::fabs(by_sums[l] - by_samples[l]) <= kConfirmed + kTolerance * std::fabs(by_samples[l]))) return false;
  return true;
}

void QuadraticScore::ExpandInSeries(QuadraticScratch* scratch) noexcept {
  const auto functions = static_cast<std::size_t>(QuadraticForm::Functions(part_.num_linear));
  const auto nodes = static_cast<std::size_t>(nodes_);
  const CosineTable& transform = *transform_;
  for (std::size_t f = 0; f < functions; ++f) {
    if (form_.needs[f] == LinearPart::kNeither) scratch->series[f] = {scratch->sums[f][0]};
    if (form_.needs[f] != LinearPart::kCurved && form_.needs[f] != LinearPart::kSecond) continue;
    for (std::size_t k = 0; k < nodes; ++k) {
      std::array<double, 4> part{};
      for (std::size_t j = 0; j < nodes; j += 4)
        for (std::size_t l = 0; l < 4; ++l) part[l] += transform[k][j + l] * scratch->sums[f][j + l];
      scratch->series[f][k] = (part[0] + part[1]) + (part[2] + part[3]);
    }
  }
  for (std::size_t product = 0; product + 1 < grid_.size(); ++product) {
    TransformColumns(transform, grid_[product], &grid_.back());
    TransformColumns(transform, grid_.back(), &grid_[product]);
  }
}

void QuadraticScore::Prepare(const ModeData& data, const Gaussian& fit, QuadraticScratch* scratch) noexcept {
  ready_ = false;
  if (!applies_ || data.start_fit != nullptr || !fit.mean.allFinite()) return;
  num_samples_ = data.num_samples;
  for (int d = 0; d < space_.dim; ++d) form_.about[static_cast<std::size_t>(d)] = fit.mean[d];
  if (part_.second >= 0)  // about 0, where what one curved parameter changes does not depend on the other
    for (int i = 0; i < part_.num_linear; ++i) {
      const auto d = static_cast<std::size_t>(part_.linear[static_cast<std::size_t>(i)]);
      form_.about[d] = -space_.offset[d] / space_.scale[d];
    }
  AccumulateSums(data, scratch);
  const auto functions = static_cast<std::size_t>(QuadraticForm::Functions(part_.num_linear));
  if (form_.num_curved == 0) {
    ready_ = true;
    for (std::size_t f = 0; f < functions; ++f) {
      form_.coefficient[f][0] = scratch->sums[f][0];
      ready_ = ready_ && std::isfinite(scratch->sums[f][0]);
    }
    return;
  }
  TabulateProducts(*scratch);
  ExpandInSeries(scratch);
  const double scale = std::exp(space_.LogNoiseScale(fit.mean.data()));
  if (part_.second >= 0) {
    if (!EndEach(scratch->series, scale * scale, fit.mean)) return;
  } else {
    const int degree = Degree(scratch->series, scale * scale);
    if (degree < 0) return;
    form_.axis[0].degree = degree;
    for (std::size_t f = 0; f < functions; ++f) {
      form_.degree[f] = degree;
      std::copy_n(scratch->series[f].begin(), static_cast<std::size_t>(degree) + 1, form_.coefficient[f].begin());
    }
  }
  ParamVector sd = Inverse(fit.precision).diagonal();
  for (int d = 0; d < space_.dim; ++d) sd[d] = sd[d] > 0.0 ? std::sqrt(sd[d]) : 1.0;
  ready_ = IsConfirmed(data, fit.mean, sd, scratch);
}

void QuadraticScore::Score(const double* const* u, int first, double* out) const noexcept {
  kernels_.score_quadratic(form_, space_, noise_, num_samples_, u, first, out);
}

}  // namespace armcmc
