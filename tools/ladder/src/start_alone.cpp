#include "start_alone.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "action.hpp"
#include "armcmc/plant/error.hpp"
#include "comparison.hpp"

namespace armcmc::ladder {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr const char* kResponse = "response_to_start";  // name of the additional signal

/// A signal times an amplitude, added to the output.
EffectEntry ResponseEntry() {
  EffectNeed need;
  need.name = "s";
  EffectForm form;
  form.needs = {need};
  form.parameters.push_back({"amplitude", "output", "normal", "0", "output", "", "", "0"});
  form.terms.push_back({"output", "", "amplitude*s"});
  EffectEntry entry;
  entry.name = entry.family = "start";
  entry.forms = {form};
  return entry;
}

/// The fitted values, with the free start values at their prior means; equal to the fit if the effect has none.
VectorXd AtRest(const Contender& c) {
  VectorXd theta = c.trial.fit.theta;
  const VectorXd centre = c.trial.model->Start();
  const EffectForm& form = c.candidate.form();
  for (std::size_t p = 0; p < form.parameters.size(); ++p) {
    const auto d = static_cast<Index>(c.candidate.first_fitted() + p);
    if (!Mentions(form, form.parameters[p].name)) theta[d] = centre[d];
  }
  return theta;
}

}  // namespace

StartAlone::StartAlone(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view,
                       const Trial& base, const DataScales& scales)
    : plant_(plant), data_(data), view_(view), base_(base), scales_(scales) {}

Trial StartAlone::WithResponse(VectorXd response) const {
  response /= std::sqrt(response.squaredNorm() / static_cast<double>(response.size()));
  auto series = std::make_shared<identify::Series>(*data_.series);
  series->signals.emplace_back(response.begin(), response.end());
  Dataset data = data_;
  data.series = std::move(series);
  PlantDescription plant = plant_->description();
  plant.signals.push_back({kResponse, "1", "", ""});
  try {
    plant = AddEffect(plant, ResponseEntry(), {0, {{"s", kResponse}}}, scales_);
    const auto with = std::make_shared<const Plant>(std::move(plant));
    VectorXd theta = identify::TrajectoryModel(with, data.series).Start();
    theta.head(base_.fit.theta.size()) = base_.fit.theta;
    Trial trial = Refine(with, data, theta);
    if (trial.fit.valid) LeaveOut(view_, &trial);
    return trial;
  } catch (const PlantError&) {  // needs more than there is room for
    return {};
  }
}

std::optional<Rival> StartAlone::RivalOf(const Contender& c, double floor) const {
  const VectorXd at_rest = AtRest(c);
  if (at_rest == c.trial.fit.theta) return std::nullopt;
  constexpr const char* kDecay = "something decayed from the beginning of the recording";
  const Rival unknown{kDecay, "may explain as much: a model with that alone cannot be fitted"};
  VectorXd from_rest;
  if (!c.trial.model->PredictOne(at_rest, &from_rest)) return unknown;
  if (from_rest == c.trial.fit.prediction) return std::nullopt;
  const Trial start = WithResponse(c.trial.fit.prediction - from_rest);
  if (!start.fit.valid) return unknown;
  const double square = start.fit.error_sd * start.fit.error_sd;
  Contender driven = c;
  driven.closed = std::clamp(1.0 - c.trial.fit.error_sd * c.trial.fit.error_sd / square, 0.0, 1.0);
  const double left = Compare(view_, driven, start, false).folds;
  const double noise = NoiseIn(view_, c.trial, floor) / square;
  if (left < 1.0 - kLeastGain && left - noise < kLargerPart * (1.0 - noise)) return std::nullopt;
  return Rival{kDecay, "explains as much"};
}

}  // namespace armcmc::ladder
