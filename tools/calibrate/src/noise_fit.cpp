#include "armcmc/calibrate/noise_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "armcmc/noise_model.hpp"

namespace armcmc::calibrate {
namespace {

constexpr std::size_t kMaxErrors = 20'000;  // more say nothing new on four numbers
constexpr std::size_t kPacksPerBlock = 5;

double MeanSquare(const std::vector<double>& errors) {
  double sum = 0.0;
  for (const double e : errors) sum += e * e;
  return sum / static_cast<double>(errors.size());
}

double MedianAbsolute(const std::vector<double>& errors) {
  std::vector<double> sizes(errors.size());
  std::transform(errors.begin(), errors.end(), sizes.begin(), [](double e) { return std::fabs(e); });
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle > 0.0 ? *middle : std::sqrt(MeanSquare(errors));
}

/// Scale of the t law with dof degrees of freedom from a start, and the log-likelihood that it reaches.
double FitScale(double dof, const std::vector<double>& errors, double* scale) {
  constexpr int kIterations = 25;
  double s2 = *scale * *scale;
  for (int i = 0; i < kIterations; ++i) {
    double sum = 0.0;
    for (const double e : errors) sum += (dof + 1.0) / (dof + e * e / s2) * e * e;
    s2 = sum / static_cast<double>(errors.size());
  }
  *scale = std::sqrt(s2);
  double log_likelihood = std::lgamma(0.5 * (dof + 1.0)) - std::lgamma(0.5 * dof) - 0.5 * std::log(dof * s2);
  double sum = 0.0;
  for (const double e : errors) sum += std::log1p(e * e / (s2 * dof));
  log_likelihood -= 0.5 * (dof + 1.0) * sum / static_cast<double>(errors.size());
  return log_likelihood;
}

void FitStudentT(const std::vector<double>& errors, NoiseSettings* noise) {
  constexpr double kGolden = 0.6180339887498949;
  double lo = 0.0, hi = std::log(200.0), scale = 1.5 * MedianAbsolute(errors);
  const auto value = [&](double log_dof) { return FitScale(std::exp(log_dof), errors, &scale); };
  double a = hi - kGolden * (hi - lo), b = lo + kGolden * (hi - lo), at_a = value(a), at_b = value(b);
  for (int i = 0; i < 16; ++i) {
    if (at_a > at_b) {
      hi = b, b = a, at_b = at_a, a = hi - kGolden * (hi - lo), at_a = value(a);
    } else {
      lo = a, a = b, at_a = at_b, b = lo + kGolden * (hi - lo), at_b = value(b);
    }
  }
  noise->dof = std::exp(0.5 * (lo + hi));
  FitScale(noise->dof, errors, &scale);
  noise->std = scale;
}

/// EM from the weight and scales in `noise`. @return mean log density without its constant.
double RunMixture(const std::vector<double>& errors, NoiseSettings* noise) {
  constexpr int kIterations = 80;
  double w = noise->outlier_weight, s = noise->std, c = noise->outlier_scale, log_density = 0.0;
  const auto n = static_cast<double>(errors.size());
  for (int i = 0; i < kIterations; ++i) {
    double weight = 0.0, wide = 0.0, narrow = 0.0;
    log_density = 0.0;
    for (const double e : errors) {
      const double z2 = e * e / (s * s);
      const double outlier = -0.5 * z2 / (c * c);
      const double p_wide = w / c, p_narrow = (1.0 - w) * std::exp(-0.5 * z2 - outlier);
      const double share = p_wide / (p_wide + p_narrow);
      log_density += outlier + std::log(p_wide + p_narrow) - std::log(s);
      weight += share;
      wide += share * e * e;
      narrow += (1.0 - share) * e * e;
    }
    w = std::clamp(weight / n, 1e-3, 0.5);
    s = std::sqrt(std::max(narrow / std::max(n - weight, 1.0), 1e-300));
    c = std::clamp(std::sqrt(wide / std::max(weight, 1e-9)) / s, 1.5, 100.0);
  }
  noise->outlier_weight = w, noise->std = s, noise->outlier_scale = c;
  return log_density / n;
}

void FitMixture(const std::vector<double>& errors, NoiseSettings* noise) {
  const NoiseSettings start = *noise;
  const double scale = 1.4826 * MedianAbsolute(errors);
  double best = -HUGE_VAL;
  for (const auto& [weight, wide] : {std::pair{0.05, 10.0}, std::pair{0.2, 3.0}, std::pair{0.01, 20.0}}) {
    NoiseSettings trial = start;
    trial.outlier_weight = weight, trial.outlier_scale = wide, trial.std = scale;
    const double value = RunMixture(errors, &trial);
    if (value > best) best = value, *noise = trial;
  }
}

/// Errors of the packs whose block has that parity (2: of all packs), thinned evenly.
std::vector<double> Collected(const PackErrors& errors, std::size_t parity) {
  std::vector<double> all;
  for (std::size_t p = 0; p < errors.size(); ++p)
    if (parity == 2 || (p / kPacksPerBlock) % 2 == parity) all.insert(all.end(), errors[p].begin(), errors[p].end());
  if (all.size() <= kMaxErrors) return all;
  const std::size_t step = all.size() / kMaxErrors + 1;
  std::vector<double> some;
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

/// Sum of log densities of every block, each under the fit that did not see it; NaN where a block is empty.
std::vector<double> HeldOutBlocks(NoiseKind kind, const PackErrors& errors, const NoiseSettings& start,
                                  std::vector<double>* counts) {
  const std::size_t blocks = (errors.size() + kPacksPerBlock - 1) / kPacksPerBlock;
  std::vector<double> sums(blocks, 0.0);
  counts->assign(blocks, 0.0);
  for (std::size_t parity = 0; parity < 2; ++parity) {
    const NoiseSettings fit = FitLaw(kind, Collected(errors, 1 - parity), start);
    const NoiseModel model(fit);
    for (std::size_t p = 0; p < errors.size(); ++p) {
      const std::size_t block = p / kPacksPerBlock;
      if (block % 2 != parity) continue;
      for (const double e : errors[p]) sums[block] += model.LogDensity(e, fit.std);
      (*counts)[block] += static_cast<double>(errors[p].size());
    }
  }
  return sums;
}

}  // namespace

NoiseSettings FitLaw(NoiseKind kind, const std::vector<double>& errors, const NoiseSettings& start) {
  NoiseSettings noise = start;
  noise.kind = kind;
  switch (kind) {
    case NoiseKind::kGaussian: noise.std = std::sqrt(MeanSquare(errors)); break;
    case NoiseKind::kLaplace: {
      double sum = 0.0;
      for (const double e : errors) sum += std::fabs(e);
      noise.std = sum / static_cast<double>(errors.size());
      break;
    }
    case NoiseKind::kStudentT: FitStudentT(errors, &noise); break;
    case NoiseKind::kMixture: FitMixture(errors, &noise); break;
  }
  return noise;
}

std::vector<LawScore> CompareLaws(const PackErrors& errors, const NoiseSettings& start) {
  constexpr std::array kKinds = {NoiseKind::kGaussian, NoiseKind::kLaplace, NoiseKind::kStudentT, NoiseKind::kMixture};
  const std::vector<double> all = Collected(errors, 2);
  std::vector<LawScore> scores;
  std::vector<std::vector<double>> blocks;
  std::vector<double> counts;
  double total = 0.0;
  for (const NoiseKind kind : kKinds) {
    LawScore score;
    score.noise = FitLaw(kind, all, start);
    blocks.push_back(HeldOutBlocks(kind, errors, start, &counts));
    double sum = 0.0;
    total = 0.0;
    for (std::size_t b = 0; b < counts.size(); ++b) sum += blocks.back()[b], total += counts[b];
    score.heldout = sum / total;
    scores.push_back(score);
  }
  const auto best = static_cast<std::size_t>(
      std::max_element(scores.begin(), scores.end(),
                       [](const LawScore& a, const LawScore& b) { return a.heldout < b.heldout; }) -
      scores.begin());
  for (std::size_t law = 0; law < scores.size(); ++law) {
    scores[law].behind = scores[best].heldout - scores[law].heldout;
    double square = 0.0;
    for (std::size_t b = 0; b < counts.size(); ++b) {
      const double off = blocks[best][b] - blocks[law][b] - scores[law].behind * counts[b];
      square += off * off;
    }
    scores[law].behind_se = std::sqrt(square) / total;
  }
  return scores;
}

std::size_t SimplestGoodLaw(const std::vector<LawScore>& scores) {
  for (std::size_t law = 0; law < scores.size(); ++law)
    if (scores[law].behind <= 2.0 * scores[law].behind_se) return law;
  return 0;  // not reached: the best law is behind by nothing
}

std::string_view Name(NoiseKind kind) {
  switch (kind) {
    case NoiseKind::kGaussian: return "gaussian";
    case NoiseKind::kStudentT: return "student_t";
    case NoiseKind::kLaplace: return "laplace";
    case NoiseKind::kMixture: return "mixture";
  }
  return "";
}

double Lag1Correlation(const PackErrors& errors) {
  double product = 0.0, square = 0.0;
  for (const std::vector<double>& pack : errors) {
    for (std::size_t i = 1; i < pack.size(); ++i) {
      product += pack[i] * pack[i - 1];
      square += 0.5 * (pack[i] * pack[i] + pack[i - 1] * pack[i - 1]);
    }
  }
  return square > 0.0 ? product / square : 0.0;
}

}  // namespace armcmc::calibrate
