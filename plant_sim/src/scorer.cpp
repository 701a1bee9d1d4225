#include "armcmc/plant_sim/scorer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace armcmc::plant_sim {
namespace {

double Mean(double sum, std::int64_t n) {
  return n > 0 ? sum / static_cast<double>(n) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Scorer::Scorer(const Scenario& scenario, std::uint64_t seed)
    : family_(*scenario.family),
      pack_samples_(scenario.pack_samples),
      stride_(scenario.stride()),
      dt_(scenario.sample_interval_s),
      simulation_(scenario, seed) {
  for (View& view : views_)
    view.parameters.assign(static_cast<std::size_t>(family_.num_modes()),
                           std::vector<Sums>(static_cast<std::size_t>(family_.num_truth())));
}

void Scorer::Add(const ReceivedEstimate& estimate) {
  // Rounding must not show an estimate at the sample that stands exactly on its arrival.
  const auto arrival = static_cast<long long>(std::floor(estimate.arrival_s / dt_)) + 1;
  const long long later = pack_samples_ + static_cast<long long>(estimate.seq) * stride_;
  for (const Convention convention : {Convention::kOnePackLater, Convention::kFromArrival}) {
    const long long from = convention == Convention::kOnePackLater ? std::max(arrival, later) : arrival;
    views_[static_cast<std::size_t>(convention)].pending.push_back({from, estimate});
  }
  if (estimate.interval_mode < 0) return;
  ++num_intervals_;
  const double t_last = static_cast<double>(pack_samples_ + (estimate.seq - 1) * stride_) * dt_;
  const Theta truth = simulation_.plant().Truth(estimate.interval_mode, t_last);
  for (std::size_t i = 0; i < family_.truth_names.size(); ++i)
    covered_[i] += estimate.lo[i] <= truth[i] && truth[i] <= estimate.hi[i] ? 1 : 0;
}

void Scorer::ScoreThrough(long long index) {
  while (simulation_.index() < index) {
    if (!simulation_.Next()) throw std::runtime_error("the plant left the finite range");
    for (View& view : views_) ScoreSample(&view);
  }
}

void Scorer::ScoreSample(View* view) const {
  while (!view->pending.empty() && view->pending.front().from_index <= simulation_.index()) {
    if (view->pending.front().estimate.seq >= view->shown.seq) view->shown = view->pending.front().estimate;
    view->pending.pop_front();
  }
  const PlantSample& truth = simulation_.truth();
  const Plant& plant = simulation_.plant();
  const bool identified = truth.mode < family_.num_modes();
  const auto mode = static_cast<std::size_t>(identified ? truth.mode : 0);
  const bool known = identified && view->shown.known[mode];
  const Theta& theta = view->shown.theta[mode];

  const double target = plant.Target(truth);
  const double predicted = known ? plant.Predict(theta, simulation_.measured()) : 0.0;
  const double error = predicted - target;
  const double noisy_error = predicted - plant.Target(simulation_.measured());
  view->target_overall += std::abs(error);
  view->clean_sq += error * error;
  view->truth_sq += target * target;
  view->noisy_sq += noisy_error * noisy_error;
  ++view->samples;
  if (!identified) return;

  view->target_in_mode += std::abs(error);
  ++view->in_mode;
  const Theta theta_true = plant.Truth(truth.mode, truth.t_s);
  for (std::size_t i = 0; i < family_.truth_names.size(); ++i) {
    Sums& sums = view->parameters[mode][i];
    const double shown = known ? theta[i] : 0.0;
    sums.abs_error += std::abs(shown - theta_true[i]);
    ++sums.samples;
    if (!known) continue;
    sums.abs_error_active += std::abs(shown - theta_true[i]);
    sums.abs_truth_active += std::abs(theta_true[i]);
    sums.last = shown;
    ++sums.active;
  }
}

Score Scorer::Result(Convention convention) const {
  const View& view = views_[static_cast<std::size_t>(convention)];
  Score score;
  for (const std::vector<Sums>& mode : view.parameters) {
    std::vector<ParameterScore>& parameters = score.modes.emplace_back();
    for (const Sums& sums : mode) {
      ParameterScore& parameter = parameters.emplace_back();
      parameter.mae = Mean(sums.abs_error, sums.samples);
      parameter.mae_active = Mean(sums.abs_error_active, sums.active);
      parameter.rel_active = sums.abs_error_active / sums.abs_truth_active;
      parameter.final_value = sums.active > 0 ? sums.last : std::numeric_limits<double>::quiet_NaN();
      parameter.samples = sums.samples;
      parameter.active_samples = sums.active;
    }
  }
  score.target_mae_in_mode = Mean(view.target_in_mode, view.in_mode);
  score.target_mae_overall = Mean(view.target_overall, view.samples);
  score.target_noisy_l2 = std::sqrt(view.noisy_sq);
  score.target_rel_l2 = std::sqrt(view.clean_sq / view.truth_sq);
  score.samples = view.samples;
  score.in_mode_samples = view.in_mode;
  return score;
}

double Scorer::Coverage(int parameter) const noexcept {
  return Mean(static_cast<double>(covered_[static_cast<std::size_t>(parameter)]), num_intervals_);
}

}  // namespace armcmc::plant_sim
