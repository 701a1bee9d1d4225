#include "armcmc/gap_watch/gap_block.hpp"

#include <algorithm>
#include <cmath>

#include "gap_tools.hpp"

namespace armcmc {
namespace {

constexpr double kDependent = 1e-9;    // pivot over diagonal below which a direction counts as linearly dependent
constexpr double kFewestPacks = 4.0;   // minimum effective number of packs for a score
constexpr double kCarryOver = 2.5;     // correlation of neighbouring means, times their samples
constexpr double kNoMean = 1e-6;       // share of a pack's mean below which its unknowns have taken it
constexpr double kConverged = 1e-3;    // mean square of the last step of the fit, in that of the errors
constexpr double kMostLeverage = 0.9;  // of a pack, above which its residual carries no information

double Dot(const double* a, const double* b, int n) noexcept {
  double sum = 0.0;
  for (int i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

void GapBlock::Clear(bool drifts) noexcept {
  directions_ = drifts ? kGapDirections : kGapSteady;
  for (PackSums& pack : packs_) pack.used = false;
  detrended_count_ = {};
}

void GapBlock::AddFit(int k, const GapRows& rows, double tau, bool changed) noexcept {
  PackSums& pack = packs_[At(k)];
  pack.used = true;
  // Legendre polynomials: as they are, nearly independent.
  pack.direction = {1.0, tau, changed ? 1.0 : 0.0, 1.5 * tau * tau - 0.5, (2.5 * tau * tau - 1.5) * tau};
  const int n = rows.num_samples;
  pack.count = static_cast<int>(std::count(rows.used.begin(), rows.used.begin() + n, true));
  pack.removed = rows.num_removed;
  pack.error_square = Dot(rows.error.data(), rows.error.data(), n);
  for (int a = 0; a < columns_; ++a) {
    pack.slope_error[At(a)] = Dot(rows.slope[At(a)].data(), rows.error.data(), n);
    for (int b = 0; b <= a; ++b)
      pack.slope_slope[At(a)][At(b)] = pack.slope_slope[At(b)][At(a)] =
          Dot(rows.slope[At(a)].data(), rows.slope[At(b)].data(), n);
  }
}

void GapBlock::Detrend(const GapRows& rows, std::array<double, kMaxPackSamples>* out) const noexcept {
  const int n = rows.num_samples;
  double mean = 0.0, slope = 0.0, square = 0.0;
  for (int i = 0; i < n; ++i) {
    const double s = i - 0.5 * (n - 1);
    mean += rows.error[At(i)] / n;
    slope += s * rows.error[At(i)];
    square += s * s;
  }
  slope = square > 0.0 ? slope / square : 0.0;
  for (int i = 0; i < n; ++i) (*out)[At(i)] = rows.error[At(i)] - mean - slope * (i - 0.5 * (n - 1));
}

void GapBlock::AddRegions(int k, const GapRows& rows, double tau, bool changed, const RegionTemplates& regions,
                          bool continues) noexcept {
  AddFit(k, rows, tau, changed);
  PackSums& pack = packs_[At(k)];
  const int n = rows.num_samples;
  for (int r = 0; r < checks_.num_regions; ++r) {
    const double* phi = regions[At(r)].data();
    RegionSums& sums = pack.region[At(r)];
    sums.error = Dot(phi, rows.error.data(), n);
    sums.square = Dot(phi, phi, n);
    sums.count = 0;
    for (int i = 0; i < n; ++i) sums.count += phi[i] != 0.0 ? 1 : 0;
    for (int a = 0; a < columns_; ++a) sums.slope[At(a)] = Dot(phi, rows.slope[At(a)].data(), n);
  }
  // Cyclic: the slots of this pack, the previous one, and the one before.
  if (!continues) detrended_count_[At((k + 2) % 3)] = detrended_count_[At((k + 1) % 3)] = 0;
  auto& own = detrended_[At(k % 3)];
  Detrend(rows, &own);
  detrended_count_[At(k % 3)] = n;
  for (int lag = 1; lag <= 2; ++lag) {
    const std::size_t other = At((k + 3 - lag) % 3);
    pack.echo[At(lag - 1)] = detrended_count_[other] == n ? Dot(own.data(), detrended_[other].data(), n) : 0.0;
  }
}

void GapBlock::SumNormalMatrix() noexcept {
  for (auto& row : matrix_) row.fill(0.0);
  for (const PackSums& pack : packs_) {
    if (!pack.used) continue;
    for (int i = 0; i < directions_; ++i)
      for (int j = 0; j <= i; ++j) {
        const double weight = pack.direction[At(i)] * pack.direction[At(j)];
        if (weight == 0.0) continue;
        for (int a = 0; a < columns_; ++a)
          for (int b = 0; b < columns_; ++b)
            matrix_[At(i * columns_ + a)][At(j * columns_ + b)] += weight * pack.slope_slope[At(a)][At(b)];
      }
  }
}

void GapBlock::AddPrecision(const std::array<double, kGapColumns>& precision, double damping) noexcept {
  for (int i = 0; i < directions_; ++i)
    for (int a = 0; a < columns_; ++a) {
      double& diagonal = matrix_[At(i * columns_ + a)][At(i * columns_ + a)];
      diagonal += precision[At(a)] + damping * diagonal;
    }
}

void GapBlock::Factor() noexcept {
  const int n = columns_ * directions_;
  for (int j = 0; j < n; ++j) {
    auto& row = matrix_[At(j)];
    const double diagonal = row[At(j)];
    for (int i = 0; i < j; ++i) {
      if (!kept_[At(i)]) {
        row[At(i)] = 0.0;
        continue;
      }
      row[At(i)] = (row[At(i)] - Dot(row.data(), matrix_[At(i)].data(), i)) / matrix_[At(i)][At(i)];
    }
    const double pivot = diagonal - Dot(row.data(), row.data(), j);
    kept_[At(j)] = pivot > kDependent * diagonal && pivot > 0.0 && std::isfinite(pivot);
    row[At(j)] = kept_[At(j)] ? std::sqrt(pivot) : 1.0;
  }
}

void GapBlock::SolveLower(Vector* x) const noexcept {
  for (int i = 0; i < columns_ * directions_; ++i)
    (*x)[At(i)] = kept_[At(i)] ? ((*x)[At(i)] - Dot(matrix_[At(i)].data(), x->data(), i)) / matrix_[At(i)][At(i)] : 0.0;
}

void GapBlock::SolveUpper(Vector* x) const noexcept {
  const int n = columns_ * directions_;
  for (int i = n - 1; i >= 0; --i) {
    if (!kept_[At(i)]) {
      (*x)[At(i)] = 0.0;
      continue;
    }
    double sum = (*x)[At(i)];
    for (int j = i + 1; j < n; ++j) sum -= kept_[At(j)] ? matrix_[At(j)][At(i)] * (*x)[At(j)] : 0.0;
    (*x)[At(i)] = sum / matrix_[At(i)][At(i)];
  }
}

GapShift GapBlock::ShiftOf(const PackSums& pack, const Vector& solution) const noexcept {
  GapShift shift{};
  for (int i = 0; i < directions_; ++i)
    for (int a = 0; a < columns_; ++a) shift[At(a)] += pack.direction[At(i)] * solution[At(i * columns_ + a)];
  return shift;
}

void GapBlock::SolveErrors(Vector* solution) const noexcept {
  solution->fill(0.0);
  for (const PackSums& pack : packs_) {
    if (!pack.used) continue;
    for (int i = 0; i < directions_; ++i)
      for (int a = 0; a < columns_; ++a)
        (*solution)[At(i * columns_ + a)] += pack.direction[At(i)] * pack.slope_error[At(a)];
  }
  SolveLower(solution);
  SolveUpper(solution);
}

void GapBlock::Fit(const std::array<double, kGapColumns>& precision, double damping,
                   std::array<GapShift, kGapBlockPacks>* shift) noexcept {
  SumNormalMatrix();
  AddPrecision(precision, damping);
  Factor();
  Vector solution;
  SolveErrors(&solution);
  for (int k = 0; k < kGapBlockPacks; ++k) (*shift)[At(k)] = ShiftOf(packs_[At(k)], solution);
}

double GapBlock::CarryOver() const noexcept {
  int packs = 0, samples = 0, removed = 0;
  for (const PackSums& pack : packs_) {
    packs += pack.used && pack.count > 0 ? 1 : 0;
    samples += pack.used ? pack.count : 0;
    removed = pack.used ? std::max(removed, pack.removed) : removed;
  }
  return samples > 0 ? std::min((2 * removed + 1) * kCarryOver * packs / samples, 1.0) : 0.0;
}

CheckScore GapBlock::ScoreRegion(int region, double tolerance, double* explained) const noexcept {
  // phi on the parameters' directions: M phi = phi - J c.
  Vector c{};
  for (const PackSums& pack : packs_) {
    if (!pack.used) continue;
    for (int i = 0; i < directions_; ++i)
      for (int a = 0; a < columns_; ++a)
        c[At(i * columns_ + a)] += pack.direction[At(i)] * pack.region[At(region)].slope[At(a)];
  }
  SolveLower(&c);
  SolveUpper(&c);
  double score = 0.0, variance = 0.0, norm = 0.0, norm_square = 0.0, full_norm = 0.0;
  int count = 0;
  for (int k = 0; k < kGapBlockPacks; ++k) {
    const PackSums& pack = packs_[At(k)];
    if (!pack.used) continue;
    const RegionSums& sums = pack.region[At(region)];
    const GapShift ck = ShiftOf(pack, c);
    const GapShift& dk = fit_[At(k)];
    double own = sums.square;                 // |(M phi)_k|^2
    double psi = sums.error;                  // (M phi)_k' r_k,  r_k = e_k - J_k d_k
    std::array<double, kGapColumns> along{};  // J_k' (M phi)_k
    for (int a = 0; a < columns_; ++a) {
      const double curved = Dot(pack.slope_slope[At(a)].data(), ck.data(), columns_);
      along[At(a)] = sums.slope[At(a)] - curved;
      own -= ck[At(a)] * (2.0 * sums.slope[At(a)] - curved);
      psi -= along[At(a)] * dk[At(a)] + ck[At(a)] * pack.slope_error[At(a)];
    }
    full_norm += sums.square;
    count += sums.count;
    if (!(own > 1e-12 * sums.square) || !(own > 0.0)) continue;
    Vector spread{};
    for (int i = 0; i < directions_; ++i)
      for (int a = 0; a < columns_; ++a) spread[At(i * columns_ + a)] = pack.direction[At(i)] * along[At(a)];
    SolveLower(&spread);
    const double leverage = std::min(Dot(spread.data(), spread.data(), columns_ * directions_) / own, kMostLeverage);
    const double free_of_fit = psi / (1.0 - leverage);
    score += psi;
    variance += free_of_fit * free_of_fit;
    norm += own;
    norm_square += own * own;
  }
  CheckScore result;
  *explained = 0.0;
  // A region that the parameters absorb almost completely would be dominated by rounding.
  if (!(norm > 1e-6 * full_norm) || norm * norm < kFewestPacks * norm_square || !(variance > 0.0)) return result;
  variance *= 1.0 + 2.0 * CarryOver();
  result.z = score / std::sqrt(variance);
  result.margin = tolerance * std::sqrt(count * norm / variance);
  *explained = std::max(score * score - variance, 0.0) / norm;
  return result;
}

CheckScore GapBlock::ScoreEcho(int lag, double tolerance, double* explained) const noexcept {
  double sum = 0.0, square = 0.0, fourth = 0.0;
  int count = 0;
  for (const PackSums& pack : packs_) {
    if (!pack.used) continue;
    const double product = pack.echo[At(lag - 1)];
    sum += product;
    square += product * product;
    fourth += product * product * product * product;
    count += pack.count;
  }
  CheckScore result;
  *explained = 0.0;
  if (!(square > 0.0) || square * square < kFewestPacks * fourth) return result;
  result.z = sum / std::sqrt(square);
  result.margin = tolerance * tolerance * count / std::sqrt(square);
  *explained = std::max(std::fabs(sum) - std::sqrt(square), 0.0);
  return result;
}

CheckScore GapBlock::ScoreWander(int lag, double tolerance, double* explained) const noexcept {
  double sum = 0.0, square = 0.0, fourth = 0.0, variance = 0.0;
  int count = 0, pairs = 0;
  std::array<double, 2> before{};  // means, in turns
  int run = 0;                     // packs without a gap before this one
  for (int k = 0; k < kGapBlockPacks; ++k) {
    const PackSums& pack = packs_[At(k)];
    const double square_of_mean =
        pack.region[0].square;  // of the constant, which is `count` unless some is projected out
    if (!pack.used || pack.count == 0 || !(square_of_mean > kNoMean * pack.count)) {
      run = 0;
      continue;
    }
    const double total = pack.region[0].error - Dot(pack.region[0].slope.data(), fit_[At(k)].data(), columns_);
    const double mean = total / std::sqrt(square_of_mean);
    const double earlier = before[At((k + lag) % 2)];
    if (run >= lag) {
      const double product = mean * earlier;
      sum += product;
      square += product * product;
      fourth += product * product * product * product;
      variance += mean * mean;
      ++pairs;
      count += pack.count;
    }
    before[At(k % 2)] = mean;
    ++run;
  }
  CheckScore result;
  *explained = 0.0;
  if (!(square > 0.0) || square * square < kFewestPacks * fourth) return result;
  result.z = sum / std::sqrt(square);
  // Fitting makes the errors of neighbours slightly anticorrelated.
  const auto fitted = std::count(kept_.begin(), kept_.begin() + columns_ * directions_, true);
  const double correlation = CarryOver() + static_cast<double>(fitted) / pairs;
  result.margin = (tolerance * tolerance * count + correlation * variance) / std::sqrt(square);
  *explained = std::max(std::fabs(sum) - std::sqrt(square), 0.0);
  return result;
}

void GapBlock::BeginScores() noexcept {
  SumNormalMatrix();
  Factor();
  Vector solution;
  SolveErrors(&solution);
  excess_ = 0.0;
  double moved = 0.0, squares = 0.0;
  int count = 0, removed = 0;
  for (int k = 0; k < kGapBlockPacks; ++k) {
    const PackSums& pack = packs_[At(k)];
    if (!pack.used) continue;
    const GapShift& dk = fit_[At(k)] = ShiftOf(pack, solution);
    excess_ += pack.error_square - (pack.count - pack.removed);
    squares += pack.error_square;
    count += pack.count;
    removed += pack.removed;
    for (int a = 0; a < columns_; ++a) moved += dk[At(a)] * Dot(pack.slope_slope[At(a)].data(), dk.data(), columns_);
    for (int a = 0; a < columns_; ++a)
      excess_ -= dk[At(a)] * (2.0 * pack.slope_error[At(a)] - Dot(pack.slope_slope[At(a)].data(), dk.data(), columns_));
  }
  const auto fitted = static_cast<double>(std::count(kept_.begin(), kept_.begin() + columns_ * directions_, true));
  excess_ += fitted;
  converged_ = removed == 0 || moved <= kConverged * std::max(static_cast<double>(count), squares);
  if (!std::isfinite(excess_)) excess_ = 0.0;
}

CheckScore GapBlock::Score(int check, double tolerance) noexcept {
  double* explained = &explained_[At(check)];
  CheckScore score;
  switch (check - checks_.num_regions) {
    case 0: score = ScoreEcho(1, tolerance, explained); break;
    case 1: score = ScoreEcho(2, tolerance, explained); break;
    case 2: score = ScoreWander(1, tolerance, explained); break;
    case 3: score = ScoreWander(2, tolerance, explained); break;
    default: score = ScoreRegion(check, tolerance, explained); break;
  }
  // Data without noise: the residual is rounding error, and its squares may underflow.
  if (!converged_ || !std::isfinite(score.z) || !std::isfinite(score.margin)) score = CheckScore{};
  if (!converged_ || !std::isfinite(*explained)) *explained = 0.0;
  return score;
}

}  // namespace armcmc
