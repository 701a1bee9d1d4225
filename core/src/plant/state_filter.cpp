#include "armcmc/plant/state_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simd/kernels.hpp"

namespace armcmc {
namespace {

/// Variance of a start that comes from the output, in that of its noise. That sample is among the data, too, which
/// alone should determine the start: with a prior of five standard deviations about it, it counts 1.04 times.
constexpr double kFromOutput = 25.0;
constexpr double kReach = 4.0;           ///< Standard deviations of a parameter over which a start follows it.
constexpr double kTrial = 0.1;           ///< Step of a start, relative to the size of the state.
constexpr double kRidge = 1e-9;          ///< Against two starts with the same effect.
constexpr double kContradiction = 12.0;  ///< Twice the log odds against the start in a file.
constexpr double kUnknown = 100.0;  ///< Variance of an unknown start, relative to that which would explain all errors.
constexpr double kNothing = 1e-9;   ///< Relative to the noise variance: a direction without effect on the data.

static_assert(kMaxStates <= kMaxParams && 1 + kMaxStates + 2 * kMaxParams <= kTileLanes);

/// L of A = L L', with zeros where A has no width. A covariance may be singular: a start may be known.
ParamMatrix SemiFactor(const ParamMatrix& a) noexcept {
  const Eigen::Index n = a.rows();
  ParamMatrix l = ParamMatrix::Zero(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    double pivot = a(j, j);
    for (Eigen::Index k = 0; k < j; ++k) pivot -= l(j, k) * l(j, k);
    if (!(pivot > 1e-12 * a(j, j)) || !(a(j, j) > 0.0)) continue;
    l(j, j) = std::sqrt(pivot);
    for (Eigen::Index i = j + 1; i < n; ++i) {
      double sum = a(i, j);
      for (Eigen::Index k = 0; k < j; ++k) sum -= l(i, k) * l(j, k);
      l(i, j) = sum / l(j, j);
    }
  }
  return l;
}

}  // namespace

void StateFilter::Linearise(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean,
                            const std::array<double, kMaxParams>& sd, double noise_std, const ModeData& data) noexcept {
  const auto n = static_cast<std::size_t>(plant_->size());
  for (std::size_t d = 0; d < kMaxParams; ++d) {
    theta_.value[d].fill(mean[d]);
    theta_.value[d][1 + n + d] += sd[d];
    theta_.value[d][1 + n + kMaxParams + d] -= sd[d];
  }
  for (std::size_t s = 0; s < n; ++s) {
    const auto i = static_cast<Eigen::Index>(s);
    step_[s] = opened_[s] > 0.0 ? trial_[s] : noise_std * std::sqrt(std::fmax(start_(i, i), 0.0));
    offset_.value[s].fill(0.0);
    offset_.value[s][1 + s] = step_[s];
  }
  kernels.run_states(data, theta_, offset_, &end_, &law_);
}

void StateFilter::Predict(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean, double noise_std,
                          ModeData* data) noexcept {
  const StateRun& run = *data->states;
  const auto n = static_cast<Eigen::Index>(plant_->size());
  start_ = run.carried ? end_covariance_ : ParamMatrix::Zero(n, n);
  const bool opened = std::any_of(opened_.begin(), opened_.end(), [](double variance) { return variance > 0.0; });
  if (!opened) fit_.shift.fill(0.0);
  fit_.count = 0;
  fit_.num_parameters = run.carried ? static_cast<int>(slope_.cols()) : 0;
  fit_.about = about_;
  fit_.reach = reach_;
  for (Eigen::Index s = 0; s < n; ++s)
    for (Eigen::Index d = 0; d < fit_.num_parameters; ++d)
      fit_.slope[static_cast<std::size_t>(s)][static_cast<std::size_t>(d)] =
          plant_->is_measured(static_cast<int>(s)) ? 0.0 : slope_(s, d);
  data->start_fit = &fit_;
  for (Eigen::Index s = 0; s < n; ++s) {
    const int state = static_cast<int>(s);
    const bool renewed = !run.carried || plant_->is_measured(state);
    if (!renewed) continue;
    start_.row(s).setZero();
    start_.col(s).setZero();
    const double slope = plant_->output_in_start(state);
    start_(s, s) = kFromOutput * slope * slope + opened_[static_cast<std::size_t>(s)];
  }
  Linearise(kernels, mean, {}, noise_std, *data);

  // T = w S L, and the eigenvectors of T' T are those of T T' seen through it.
  factor_ = SemiFactor(start_);
  ParamMatrix gram = ParamMatrix::Zero(n, n);
  ParamVector row(n), right = ParamVector::Zero(n);
  const auto row_of = [&](std::size_t k) {
    for (Eigen::Index j = 0; j < n; ++j) {
      row[j] = 0.0;
      for (Eigen::Index s = j; s < n; ++s) {
        const auto is = static_cast<std::size_t>(s);
        if (step_[is] > 0.0) row[j] += (law_.value[k][1 + is] - law_.value[k][0]) / step_[is] * factor_(s, j);
      }
      row[j] *= data->weight[k];
    }
  };
  const auto samples = static_cast<std::size_t>(data->num_samples);
  for (std::size_t k = 0; k < samples; ++k) {
    row_of(k);
    const double e = data->weight[k] * (data->target[k] - law_.value[k][0]);
    for (Eigen::Index i = 0; i < n; ++i) {
      right[i] += row[i] * e;
      for (Eigen::Index j = 0; j <= i; ++j) gram(i, j) += row[i] * row[j];
    }
  }
  if (!gram.allFinite()) return;
  if (opened) {
    // So that the remainder is small if its effect depends on the parameters.
    ParamMatrix information = gram;
    for (Eigen::Index i = 0; i < n; ++i) information(i, i) += 1.0;
    const ParamVector moved = Multiply(factor_, SymmetricFactor(information).Solve(right));
    for (Eigen::Index s = 0; s < n; ++s) {
      const auto is = static_cast<std::size_t>(s);
      if (opened_[is] > 0.0 && std::isfinite(moved[s])) fit_.shift[is] += moved[s];
    }
  }
  const SymmetricEigen eigen = EigenOfSymmetric(gram);
  if (!eigen.converged) return;
  for (Eigen::Index j = 0; j < n; ++j) {
    const double value = eigen.values[j];
    if (!(value > kNothing)) continue;
    const auto c = static_cast<std::size_t>(fit_.count++);
    fit_.shrink[c] = 1.0 - 1.0 / std::sqrt(1.0 + value);
    for (std::size_t k = 0; k < samples; ++k) {
      row_of(k);
      double sum = 0.0;
      for (Eigen::Index i = 0; i < n; ++i) sum += row[i] * eigen.vectors(i, j);
      fit_.direction[c][k] = sum / std::sqrt(value);
    }
  }
}

double StateFilter::SquaresLeft(const ModeData& data) noexcept {
  const Eigen::Index size = plant_->size();
  ParamMatrix gram = ParamMatrix::Zero(size, size);
  ParamVector right = ParamVector::Zero(size), row(size);
  double squares = 0.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(data.num_samples); ++k) {
    const double w = data.weight[k], e = w * (data.target[k] - law_.value[k][0]);
    squares += e * e;
    for (Eigen::Index i = 0; i < size; ++i) {
      row[i] = w * (law_.value[k][1 + static_cast<std::size_t>(i)] - law_.value[k][0]);
      right[i] += row[i] * e;
      for (Eigen::Index j = 0; j <= i; ++j) gram(i, j) += row[i] * row[j];
    }
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    sensitivity_[static_cast<std::size_t>(i)] = gram(i, i);
    gram(i, i) += kRidge * gram(i, i) + std::numeric_limits<double>::min();
  }
  return squares - right.dot(SymmetricFactor(gram).Solve(right));
}

double StateFilter::OpenStart(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean,
                              double noise_std, const ModeData& data) noexcept {
  if (data.states->carried) return -1.0;
  Linearise(kernels, mean, {}, noise_std, data);
  const double fixed_squares = SquaresLeft(data);
  const auto n = static_cast<std::size_t>(plant_->size());
  num_opened_ = 0;
  for (std::size_t s = 0; s < n; ++s) {
    trial_[s] = 0.0;
    if (!plant_->has_given_start(static_cast<int>(s)) || step_[s] > 0.0) continue;
    trial_[s] = kTrial * std::fabs(end_.value[s][0]);
    if (trial_[s] > 0.0) offset_.value[s][1 + s] = trial_[s];
  }
  kernels.run_states(data, theta_, offset_, &end_, &law_);
  static_cast<void>(SquaresLeft(data));
  for (std::size_t s = 0; s < n; ++s) {
    if (!(trial_[s] > 0.0) || !(sensitivity_[s] > 0.0)) continue;
    opened_[s] = kUnknown * fixed_squares * trial_[s] * trial_[s] / (sensitivity_[s] * noise_std * noise_std);
    ++num_opened_;
  }
  return num_opened_ > 0 ? fixed_squares : -1.0;
}

bool StateFilter::StartIsContradicted(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean,
                                      double noise_std, const ModeData& data, double fixed_squares) noexcept {
  Linearise(kernels, mean, {}, noise_std, data);
  const double samples = data.num_samples;
  if (samples * std::log(fixed_squares / SquaresLeft(data)) > num_opened_ * std::log(samples) + kContradiction)
    return true;
  opened_.fill(0.0);
  return false;
}

void StateFilter::Update(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean,
                         const std::array<double, kMaxParams>& sd, double noise_std, const ModeData& data,
                         std::array<double, kMaxStates>* end) noexcept {
  const auto n = static_cast<Eigen::Index>(plant_->size());
  const auto at = [](Eigen::Index s) { return static_cast<std::size_t>(s); };
  Linearise(kernels, mean, sd, noise_std, data);
  const auto answer = [&](const std::array<double, kTileLanes>& value, Eigen::Index s) {
    return step_[at(s)] > 0.0 ? (value[1 + at(s)] - value[0]) / step_[at(s)] : 0.0;
  };

  std::size_t parameters = 0;
  while (parameters < kMaxParams && sd[parameters] > 0.0) ++parameters;
  const auto np = static_cast<Eigen::Index>(parameters);
  const auto by_parameter = [&](const std::array<double, kTileLanes>& value, Eigen::Index d) {
    return (value[1 + at(n) + at(d)] - value[0]) / sd[at(d)];
  };

  // A = L (I + L' S' S L)^-1 L', so that a start that is known stays known.
  ParamMatrix information = ParamMatrix::Identity(n, n);
  ParamMatrix crossed = ParamMatrix::Zero(n, np);  // L' S' (S G + S_theta)
  ParamVector right = ParamVector::Zero(n);
  double squares = 0.0;
  ParamVector row(n);
  for (std::size_t k = 0; k < static_cast<std::size_t>(data.num_samples); ++k) {
    const double w = data.weight[k];
    const double e = w * (data.target[k] - law_.value[k][0]);
    squares += e * e;
    for (Eigen::Index j = 0; j < n; ++j) {
      row[j] = 0.0;
      for (Eigen::Index s = j; s < n; ++s) row[j] += w * answer(law_.value[k], s) * factor_(s, j);
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      right[i] += row[i] * e;
      for (Eigen::Index d = 0; d < np; ++d) crossed(i, d) += row[i] * w * by_parameter(law_.value[k], d);
      for (Eigen::Index j = 0; j < n; ++j) information(i, j) += row[i] * row[j];
    }
  }
  const SymmetricFactor factor(information);
  const ParamVector solved_right = factor.Solve(right);
  const ParamVector moved = Multiply(factor_, solved_right);
  // The residual of the pack beyond its noise is model error, which limits the precision of the states.
  const double left = (squares - right.dot(solved_right)) / (noise_std * noise_std * data.num_samples);
  const double doubt = kForget * std::fmax(1.0, left);
  ParamMatrix spread(n, n);  // F L
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      spread(i, j) = 0.0;
      for (Eigen::Index s = j; s < n; ++s) spread(i, j) += answer(end_.value[at(i)], s) * factor_(s, j);
    }
  const auto bend = [&](Eigen::Index s, std::size_t d) {
    const std::array<double, kTileLanes>& x = end_.value[at(s)];
    return 0.5 * (x[1 + at(n) + d] + x[1 + at(n) + kMaxParams + d]) - x[0];
  };
  end_covariance_ = ParamMatrix::Zero(n, n);
  slope_ = ParamMatrix::Zero(n, np);
  for (Eigen::Index d = 0; d < np; ++d) {
    const ParamVector solved = factor.Solve(crossed.col(d));
    for (Eigen::Index i = 0; i < n; ++i) {
      slope_(i, d) = by_parameter(end_.value[at(i)], d);
      for (Eigen::Index k = 0; k < n; ++k) slope_(i, d) -= spread(i, k) * solved[k];
    }
    about_[at(d)] = mean[at(d)];
    reach_[at(d)] = kReach * sd[at(d)];
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const ParamVector solved = factor.Solve(spread.row(i).transpose());
    double x = end_.value[at(i)][0];
    for (Eigen::Index s = 0; s < n; ++s) x += answer(end_.value[at(i)], s) * moved[s];
    (*end)[at(i)] = x;
    for (Eigen::Index j = 0; j < n; ++j) {
      double sum = 0.0;
      for (Eigen::Index k = 0; k < n; ++k) sum += spread(j, k) * solved[k];
      // Effect of the parameters on the linearisation.
      double bent = 0.0;
      for (std::size_t d = 0; d < parameters; ++d) bent += bend(i, d) * bend(j, d);
      end_covariance_(i, j) = doubt * sum + bent / (noise_std * noise_std);
    }
  }
  if (!end_covariance_.allFinite()) end_covariance_.setZero();
  if (!slope_.allFinite()) slope_.setZero();
}

}  // namespace armcmc
