#include "armcmc/plant/state_filter.hpp"

#include <algorithm>
#include <cmath>

#include "simd/kernels.hpp"

namespace armcmc {
namespace {

/// Variance of a start that comes from the output, in that of its noise. That sample is among the data, too, which
/// alone shall say where the start is: a prior of five standard deviations about it counts it 1.04 times.
constexpr double kFromOutput = 25.0;
constexpr double kNothing = 1e-9;  ///< Of the noise's variance: a direction that the data do not feel.

static_assert(kMaxStates <= kMaxParams && 1 + kMaxStates + kMaxParams <= kTileLanes);

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
  }
  for (std::size_t s = 0; s < n; ++s) {
    const auto i = static_cast<Eigen::Index>(s);
    step_[s] = noise_std * std::sqrt(std::fmax(start_(i, i), 0.0));
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
  for (Eigen::Index s = 0; s < n; ++s) {
    const int state = static_cast<int>(s);
    const bool renewed = !run.carried || plant_->is_measured(state);
    if (!renewed) continue;
    start_.row(s).setZero();
    start_.col(s).setZero();
    const double slope = plant_->output_in_start(state);
    start_(s, s) = kFromOutput * slope * slope;
  }
  Linearise(kernels, mean, {}, noise_std, *data);

  // T = w S L, and the eigenvectors of T' T are those of T T' seen through it.
  factor_ = SemiFactor(start_);
  ParamMatrix gram = ParamMatrix::Zero(n, n);
  ParamVector row(n);
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
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j <= i; ++j) gram(i, j) += row[i] * row[j];
  }
  fit_.count = 0;
  data->start_fit = &fit_;
  if (!gram.allFinite()) return;
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

void StateFilter::Update(const simd::Kernels& kernels, const std::array<double, kMaxParams>& mean,
                         const std::array<double, kMaxParams>& sd, double noise_std, const ModeData& data,
                         std::array<double, kMaxStates>* end) noexcept {
  const auto n = static_cast<Eigen::Index>(plant_->size());
  const auto at = [](Eigen::Index s) { return static_cast<std::size_t>(s); };
  Linearise(kernels, mean, sd, noise_std, data);
  const auto answer = [&](const std::array<double, kTileLanes>& value, Eigen::Index s) {
    return step_[at(s)] > 0.0 ? (value[1 + at(s)] - value[0]) / step_[at(s)] : 0.0;
  };

  // A = L (I + L' S' S L)^-1 L', so that a start that is known stays known.
  ParamMatrix information = ParamMatrix::Identity(n, n);
  ParamVector right = ParamVector::Zero(n);
  ParamVector row(n);
  for (std::size_t k = 0; k < static_cast<std::size_t>(data.num_samples); ++k) {
    const double w = data.weight[k];
    const double e = w * (data.target[k] - law_.value[k][0]);
    for (Eigen::Index j = 0; j < n; ++j) {
      row[j] = 0.0;
      for (Eigen::Index s = j; s < n; ++s) row[j] += w * answer(law_.value[k], s) * factor_(s, j);
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      right[i] += row[i] * e;
      for (Eigen::Index j = 0; j < n; ++j) information(i, j) += row[i] * row[j];
    }
  }
  const SymmetricFactor factor(information);
  const ParamVector moved = Multiply(factor_, factor.Solve(right));
  ParamMatrix spread(n, n);  // F L
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      spread(i, j) = 0.0;
      for (Eigen::Index s = j; s < n; ++s) spread(i, j) += answer(end_.value[at(i)], s) * factor_(s, j);
    }
  end_covariance_ = ParamMatrix::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ParamVector solved = factor.Solve(spread.row(i).transpose());
    double x = end_.value[at(i)][0];
    for (Eigen::Index s = 0; s < n; ++s) x += answer(end_.value[at(i)], s) * moved[s];
    (*end)[at(i)] = x;
    for (Eigen::Index j = 0; j < n; ++j) {
      double sum = 0.0;
      for (Eigen::Index k = 0; k < n; ++k) sum += spread(j, k) * solved[k];
      double apart = 0.0;
      for (std::size_t d = 0; d < kMaxParams; ++d) {
        const std::size_t lane = 1 + at(n) + d;
        apart += (end_.value[at(i)][lane] - end_.value[at(i)][0]) * (end_.value[at(j)][lane] - end_.value[at(j)][0]);
      }
      end_covariance_(i, j) = kForget * sum + apart / (noise_std * noise_std);
    }
  }
  if (!end_covariance_.allFinite()) end_covariance_.setZero();
}

}  // namespace armcmc
