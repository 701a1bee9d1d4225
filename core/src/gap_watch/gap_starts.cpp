#include "armcmc/gap_watch/gap_starts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "armcmc/linear_algebra.hpp"
#include "gap_tools.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kRounding = 1e-12;   // of squares: differences are good to about 1e-8
constexpr double kCollinear = 1e-10;  // likewise, of a direction beside the others
constexpr double kStepEffect = 0.1;   // of the step of a difference quotient, in units of the noise
constexpr double kLargestStep = 1e-2, kSmallestStep = 1e-7;  // relative to the size of the state
constexpr double kFirstStep = 1e-3;                          // while a state has been nothing but 0
constexpr double kSizeFades = 0.99;                          // of the size of a state, from pack to pack
constexpr double kStartsConverged = 9.0;                // squared error that the fit may have left along its directions
constexpr std::array<double, 3> kAway{-0.3, 0.3, 1.0};  // guesses of a state, in its size
constexpr std::array<double, 7> kDamping{
    1e-10, 1e-7, 1e-5, 1e-3, 0.1, 10.0, std::numeric_limits<double>::infinity()};  // the last one: no step

static_assert(3 + kAway.size() * kMaxStates <= kTileLanes && kMaxStates <= kMaxParams);

double Dot(const GapDirections::Samples& a, const GapDirections::Samples& b, int n) noexcept {
  double sum = 0.0;
  for (int i = 0; i < n; ++i) sum += a[At(i)] * b[At(i)];
  return sum;
}

}  // namespace

void GapDirections::Clear(int num_samples) noexcept {
  num_samples_ = num_samples;
  count_ = 0;
}

void GapDirections::Add(const Samples& direction) noexcept {
  if (count_ == kMaxStates) return;
  Samples& own = direction_[At(count_)];
  const double before = Dot(direction, direction, num_samples_);
  std::copy_n(direction.begin(), num_samples_, own.begin());
  // Twice is enough.
  for (int pass = 0; pass < 2; ++pass)
    for (int j = 0; j < count_; ++j) {
      const double along = Dot(own, direction_[At(j)], num_samples_);
      for (int i = 0; i < num_samples_; ++i) own[At(i)] -= along * direction_[At(j)][At(i)];
    }
  const double left = Dot(own, own, num_samples_);
  if (!(left > kCollinear * before) || !std::isfinite(left)) return;
  for (int i = 0; i < num_samples_; ++i) own[At(i)] /= std::sqrt(left);
  ++count_;
}

void GapDirections::Remove(Samples* values) const noexcept {
  if (count_ == 0) return;
  const double before = Dot(*values, *values, num_samples_);
  for (int j = 0; j < count_; ++j) {
    const double along = Dot(*values, direction_[At(j)], num_samples_);
    for (int i = 0; i < num_samples_; ++i) (*values)[At(i)] -= along * direction_[At(j)][At(i)];
  }
  if (!(Dot(*values, *values, num_samples_) > kRounding * before)) std::fill_n(values->begin(), num_samples_, 0.0);
}

double GapDirections::SquaresAlong(const Samples& values) const noexcept {
  double sum = 0.0;
  for (int j = 0; j < count_; ++j) {
    const double along = Dot(values, direction_[At(j)], num_samples_);
    sum += along * along;
  }
  return sum;
}

void GapStarts::Reset() noexcept {
  last_ = LastPack{};
  size_.fill(0.0);
  step_.fill(0.0);
}

double GapStarts::SquaresOf(const ModeData& data, std::size_t lane) const noexcept {
  double sum = 0.0;
  for (std::size_t k = 0; k < At(data.num_samples); ++k) {
    const double error = (data.target[k] - law_.value[k][lane]) / noise_std_;
    sum += error * error;
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

void GapStarts::RunFrom(const ModeData& data, StateRun* run) noexcept {
  for (std::size_t s = 0; s < NumStates(); ++s) {
    run->given[s] = true;
    run->value[s] = start_[s];
  }
  kernels_.run_states(data, theta_, offset_, &end_, &law_);
}

bool GapStarts::Guess(bool continues, ModeData* data, StateRun* run) noexcept {
  for (auto& lanes : offset_.value) lanes.fill(0.0);
  // The end of a run over the first sample alone is the start.
  const int samples = data->num_samples, run_samples = run->num_samples;
  data->num_samples = 0;
  run->num_samples = 1;
  kernels_.run_states(*data, theta_, offset_, &end_, &law_);
  data->num_samples = samples;
  run->num_samples = run_samples;
  for (std::size_t s = 0; s < NumStates(); ++s) {
    start_[s] = std::isfinite(end_.value[s][0]) ? end_.value[s][0] : 0.0;
    if (!continues) continue;
    const int state = static_cast<int>(s);
    const bool from_signal = plant_.is_measured(state) || plant_.output_in_start(state) != 0.0;
    offset_.value[s].fill(end_of_last_[s] - start_[s]);
    offset_.value[s][0] = 0.0;
    if (from_signal) std::fill(offset_.value[s].begin() + 2, offset_.value[s].end(), 0.0);
  }
  // Where a state has stopped to act, as an empty tank does, no derivative leads away.
  for (std::size_t s = 0; s < NumStates(); ++s)
    for (std::size_t i = 0; i < kAway.size(); ++i) offset_.value[s][3 + kAway.size() * s + i] += kAway[i] * size_[s];
  RunFrom(*data, run);
  std::size_t best = 0;
  double least = SquaresOf(*data, 0);
  for (std::size_t lane = 1; lane < 3 + kAway.size() * NumStates(); ++lane) {
    const double squares = SquaresOf(*data, lane);
    const double chance = lane < 3 ? 0.0 : kStartsConverged * std::max(1.0, squares / data->num_samples);
    if (squares + chance < least) {
      least = squares;
      best = lane;
    }
  }
  for (std::size_t s = 0; s < NumStates(); ++s) {
    start_[s] += offset_.value[s][best];
    size_[s] = std::max({kSizeFades * size_[s], std::fabs(start_[s]), std::fabs(end_.value[s][best])});
  }
  return std::isfinite(least);
}

void GapStarts::Differentiate(const ModeData& data, StateRun* run) noexcept {
  for (std::size_t s = 0; s < NumStates(); ++s) {
    if (!(step_[s] > 0.0)) step_[s] = size_[s] > 0.0 ? kFirstStep * size_[s] : kFirstStep;
    used_step_[s] = step_[s];
    offset_.value[s].fill(0.0);
    offset_.value[s][1 + 2 * s] = step_[s];
    offset_.value[s][2 + 2 * s] = -step_[s];
  }
  RunFrom(data, run);
  for (std::size_t s = 0; s < NumStates(); ++s) {
    double square = 0.0;
    for (std::size_t k = 0; k < At(data.num_samples); ++k) square += Slope(k, s) * Slope(k, s);
    const double effect = std::sqrt(square / data.num_samples);
    const double suits = effect > 0.0 && std::isfinite(effect) ? kStepEffect / effect : kLargestStep * size_[s];
    step_[s] = size_[s] > 0.0 ? std::clamp(suits, kSmallestStep * size_[s], kLargestStep * size_[s]) : suits;
  }
}

void GapStarts::Improve(const ModeData& data, StateRun* run) noexcept {
  const auto n = static_cast<Eigen::Index>(plant_.size());
  ParamMatrix gram = ParamMatrix::Zero(n, n);
  ParamVector right = ParamVector::Zero(n), row(n);
  for (std::size_t k = 0; k < At(data.num_samples); ++k) {
    const double error = (data.target[k] - law_.value[k][0]) / noise_std_;
    for (Eigen::Index i = 0; i < n; ++i) {
      row[i] = Slope(k, static_cast<std::size_t>(i));
      right[i] += row[i] * error;
      for (Eigen::Index j = 0; j <= i; ++j) gram(i, j) += row[i] * row[j];
    }
  }
  if (!gram.allFinite() || !right.allFinite()) return;
  ParamVector scale(n);
  for (Eigen::Index i = 0; i < n; ++i) scale[i] = gram(i, i) > 0.0 ? 1.0 / std::sqrt(gram(i, i)) : 0.0;
  for (std::size_t lane = 0; lane < kDamping.size(); ++lane) {
    ParamMatrix damped = ParamMatrix::Identity(n, n);
    ParamVector scaled = ParamVector::Zero(n);
    const bool moves = std::isfinite(kDamping[lane]);
    for (Eigen::Index i = 0; i < n && moves; ++i) {
      scaled[i] = scale[i] * right[i];
      for (Eigen::Index j = 0; j < i; ++j) damped(i, j) = scale[i] * gram(i, j) * scale[j];
      damped(i, i) = 1.0 + kDamping[lane];
    }
    const ParamVector moved = SymmetricFactor(damped).Solve(scaled);
    for (Eigen::Index i = 0; i < n; ++i)
      offset_.value[static_cast<std::size_t>(i)][lane] = std::isfinite(moved[i]) ? scale[i] * moved[i] : 0.0;
  }
  RunFrom(data, run);
  std::array<double, kDamping.size()> squares{};
  for (std::size_t lane = 0; lane < squares.size(); ++lane) squares[lane] = SquaresOf(data, lane);
  const double least = *std::min_element(squares.begin(), squares.end());
  // One square more is what a direction explains by chance.
  const double enough = least * (1.0 + 1.0 / data.num_samples);
  std::size_t chosen = squares.size() - 1;
  while (chosen > 0 && !(squares[chosen] <= enough)) --chosen;
  for (std::size_t s = 0; s < NumStates(); ++s) start_[s] += offset_.value[s][chosen];
}

bool GapStarts::Fit(const DataPack& pack, const std::array<double, kMaxParams>& theta, double noise_std, ModeData* data,
                    StateRun* run) noexcept {
  const bool continues = last_.ContinuesWith(pack);
  last_ = LastPack{};
  noise_std_ = noise_std;
  directions_.Clear(pack.num_samples);
  for (std::size_t d = 0; d < kMaxParams; ++d) theta_.value[d].fill(theta[d]);
  if (!Guess(continues, data, run)) return false;
  Differentiate(*data, run);
  for (int i = 0; i < kIterations; ++i) {
    Improve(*data, run);
    Differentiate(*data, run);
  }
  bool finite = true;
  for (std::size_t s = 0; s < NumStates(); ++s) {
    GapDirections::Samples direction{};
    for (std::size_t k = 0; k < At(data->num_samples); ++k) {
      direction[static_cast<std::size_t>(data->sample[k])] = Slope(k, s);
      finite = finite && std::isfinite(Slope(k, s));
    }
    directions_.Add(direction);
    end_of_last_[s] = end_.value[s][0];
    finite = finite && std::isfinite(end_of_last_[s]);
  }
  if (!finite) return false;
  last_ = LastPack::Of(pack);
  GapDirections::Samples error{};
  for (std::size_t k = 0; k < At(data->num_samples); ++k)
    error[static_cast<std::size_t>(data->sample[k])] = (data->target[k] - law_.value[k][0]) / noise_std_;
  return directions_.SquaresAlong(error) <= kStartsConverged * std::max(1.0, SquaresOf(*data, 0) / data->num_samples);
}

}  // namespace armcmc
