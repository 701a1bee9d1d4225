#include "derived_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "comparison.hpp"

namespace armcmc::ladder {
namespace {

/// Smooths with a Gaussian kernel of that standard deviation in samples, cut at three of them and at the ends of a run.
std::vector<double> SmoothedOver(const std::vector<double>& value, const std::vector<std::size_t>& runs, double sd) {
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(3.0 * sd));
  std::vector<double> out(value.size());
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const auto from = static_cast<std::ptrdiff_t>(runs[r]);
    const auto to = static_cast<std::ptrdiff_t>(r + 1 < runs.size() ? runs[r + 1] : value.size());
    for (std::ptrdiff_t n = from; n < to; ++n) {
      double sum = 0.0, weights = 0.0;
      const std::ptrdiff_t side = std::min({reach, n - from, to - 1 - n});  // symmetric
      for (std::ptrdiff_t k = -side; k <= side; ++k) {
        const double weight = std::exp(-0.5 * static_cast<double>(k * k) / (sd * sd));
        sum += weight * value[static_cast<std::size_t>(n + k)];
        weights += weight;
      }
      out[static_cast<std::size_t>(n)] = sum / weights;
    }
  }
  return out;
}

}  // namespace

void DerivedNoise::FitSmoothed() {
  fitted_ = true;
  const PlantDescription& plant = plant_->description();
  std::vector<std::size_t> derived;
  for (std::size_t s = 0; s < plant.signals.size(); ++s)
    if (!plant.signals[s].derivative_of.empty() && plant.signals[s].name != plant.output) derived.push_back(s);
  if (derived.empty()) return;
  for (const double sd : {2.0, 5.0, 12.0}) {
    auto series = std::make_shared<identify::Series>(*data_.series);
    for (const std::size_t s : derived)
      series->signals[s] = SmoothedOver(data_.series->signals[s], data_.series->runs, sd);
    Dataset smooth = data_;
    smooth.series = std::move(series);
    Contender c{};
    c.trial = Refine(plant_, smooth, base_.fit.theta);
    if (!c.trial.fit.valid) continue;
    LeaveOut(view_, &c.trial);
    c.closed = std::clamp(1.0 - std::pow(c.trial.fit.error_sd / base_.fit.error_sd, 2), 0.0, 1.0);
    c.alone = Compare(view_, c, base_, false);
    if (!best_ || c.alone.folds < best_->contender.alone.folds)
      best_.emplace(Smoothed{sd * data_.series->dt, std::move(smooth), std::move(c)});
  }
}

bool DerivedNoise::GainsThere(const Contender& c) const {
  constexpr double kAsMuch = 0.5;
  Contender there = c;
  there.trial = Refine(c.candidate.plant, best_->data, c.trial.fit.theta);
  if (!there.trial.fit.valid) return true;
  LeaveOut(view_, &there.trial);
  const double gain = 1.0 - Compare(view_, there, best_->contender.trial, false).folds;
  return gain > kAsMuch * (1.0 - c.alone.folds);
}

std::optional<Rival> DerivedNoise::RivalOf(const Contender& c) {
  if (!fitted_) FitSmoothed();
  if (!best_ || best_->contender.alone.folds > 1.0 - kLeastGain) return std::nullopt;
  if (!BetterEverywhere(best_->contender, c) && GainsThere(c)) return std::nullopt;
  char text[64];
  std::snprintf(text, sizeof(text), "signals that are rates of others were smoother, over %.2g s", best_->sd);
  const double times = c.alone.folds / std::max(best_->contender.alone.folds, 1e-12);
  return Rival{text, times > 1.0 ? LeavesLessText(times) : "leaves little of what it explains"};
}

}  // namespace armcmc::ladder
