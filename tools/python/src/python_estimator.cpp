#include "python_estimator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "armcmc/models/registry.hpp"
#include "armcmc/plant/program.hpp"

namespace armcmc::python {
namespace {

constexpr std::int64_t kRunId = 1;
constexpr double kLatest = 9e9;  // s: what nanoseconds of 64 bits hold; seconds since 1970 are 2e9

/// Of effects, baselines and rates as the estimator samples them.
Composition CompositionOf(EstimatorSettings settings) {
  settings.regress_rate = settings.regress_rate && settings.method != Method::kRls;
  return Composition(settings);
}

std::string List(const std::vector<Signal>& signals) {
  std::string words;
  for (const Signal& signal : signals) words += (words.empty() ? "" : ", ") + signal.name;
  return words;
}

[[noreturn]] void Refuse(const std::string& words) { throw std::invalid_argument(words); }

}  // namespace

PythonEstimator::PythonEstimator(const EstimatorSettings& settings)
    : estimator_(settings),
      composition_(CompositionOf(settings)),
      result_(estimator_.MakeResult()),
      pack_(std::make_unique<DataPack>()) {
  for (int m = 0; m < estimator_.num_modes(); ++m)
    spaces_.emplace_back(composition_.sampled(), settings.noise[static_cast<std::size_t>(m)]);
}

void PythonEstimator::Check(const Samples& s, double dt, double t_last) const {
  const int inputs = estimator_.num_inputs();
  if (s.num_samples < 1) Refuse("y is empty: give at least one sample");
  if (s.num_samples > kMaxPackSamples)
    Refuse("a pack holds at most " + std::to_string(kMaxPackSamples) + " samples, y has " +
           std::to_string(s.num_samples) + ": cut the data into packs and call step() for each");
  if (s.num_inputs != inputs)
    Refuse("u has " + std::to_string(s.num_inputs) + " columns, expected " + std::to_string(inputs) + ": " +
           List(Inputs()));
  if (!std::isfinite(dt) || dt <= 0.0 || dt > kLatest)
    Refuse("dt is the sample interval in seconds: give a number above 0");
  if (!std::isnan(t_last) && std::fabs(t_last) > kLatest)
    Refuse("t_last is the time of the last sample in seconds: give a finite number of at most 9e9");
  if (!std::isnan(t_last) && seq_ > 0 && t_last <= t_last_)
    Refuse("t_last = " + std::to_string(t_last) + " s is not after the pack before, which ended at " +
           std::to_string(t_last_) + " s: give packs in order, or call reset() to begin another run");
  for (int n = 0; n < s.num_samples; ++n) {
    const std::string where = " at sample " + std::to_string(n) + ": leave out the pack, or fill the gap";
    if (!std::isfinite(s.y[n])) Refuse("y is not finite" + where);
    for (int i = 0; i < inputs; ++i)
      if (!std::isfinite(s.u[n * inputs + i]))
        Refuse("u, column " + Inputs()[static_cast<std::size_t>(i)].name + ", is not finite" + where);
  }
}

Estimate PythonEstimator::Step(const Samples& s, double dt, double t_last) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Check(s, dt, t_last);
  const double length = s.num_samples * dt;
  const double t = std::isnan(t_last) ? t_last_ + length : t_last;
  if (t > kLatest) Refuse("the pack would end later than 9e9 s: call reset() to begin another run");
  // Of packs that are missing before this one, the numbers are left out.
  const double packs = seq_ > 0 ? std::round((t - t_last_) / length) : 1.0;
  const std::int64_t seq = seq_ + static_cast<std::int64_t>(std::clamp(packs, 1.0, 1e12));
  DataPack& pack = *pack_;
  pack.seq = seq;
  pack.run_id = kRunId;
  pack.t_last_s = t;
  pack.t_last_ns = static_cast<Nanos>(std::llround(t * 1e9));
  pack.dt = dt;
  pack.plant = estimator_.plant();
  pack.fingerprint = settings().plant != nullptr ? settings().plant->plant().fingerprint() : 0;
  pack.num_samples = s.num_samples;
  pack.num_inputs = s.num_inputs;
  for (std::size_t n = 0; n < static_cast<std::size_t>(s.num_samples); ++n) {
    pack.y[n] = s.y[n];
    const double* row = s.u + n * static_cast<std::size_t>(s.num_inputs);
    std::copy_n(row, s.num_inputs, pack.u[n].begin());
  }
  const Status status = estimator_.Draw(pack, std::numeric_limits<Nanos>::max(), ClockRef{}, result_.get());
  if (status == Status::kBadPack)
    Refuse("the model cannot be computed for these samples: look for inputs outside the range of its law");
  Estimate estimate;
  estimator_.Execute(*result_, &estimate);
  estimator_.Remember(ClockRef{});
  seq_ = seq;
  t_last_ = t;
  return estimate;
}

void PythonEstimator::CheckMode(int mode) const {
  const int modes = estimator_.num_modes();
  if (mode < 0 || mode >= modes)
    Refuse("mode " + std::to_string(mode) + " does not exist: give 0 to " + std::to_string(modes - 1));
}

std::vector<DrawColumn> PythonEstimator::DrawColumns(int mode) const {
  CheckMode(mode);
  const ModelInfo& info = composition_.info();
  std::vector<DrawColumn> columns;
  for (int d = 0; d < info.num_parameters; ++d) {
    const ReportedQuantity quantity = estimator_.reported(info.ReportedOf(d));
    columns.push_back({std::string(quantity.name), std::string(quantity.unit)});
  }
  if (SpaceOf(mode).samples_noise_scale()) columns.push_back({"noise_std", std::string(estimator_.target_unit())});
  return columns;
}

DrawTable PythonEstimator::Draws(int mode) {
  const std::lock_guard<std::mutex> lock(mutex_);
  CheckMode(mode);
  const ModeDraws& draws = result_->modes[static_cast<std::size_t>(mode)];
  if (seq_ == 0 || !draws.updated)
    Refuse("the newest step has drawn nothing of mode " + std::to_string(mode) + " (" +
           std::string(estimator_.mode_name(mode)) + "): look at estimate.modes[mode].updated before");
  const ModelInfo& info = composition_.info();
  const ParameterSpace& space = SpaceOf(mode);
  DrawTable table;
  table.num_columns = space.dim;
  for (int k = 0; k < draws.draws; ++k) {
    if (!(draws.weight[k] > 0.0)) continue;
    std::array<double, kMaxParams> theta{};
    for (int d = 0; d < space.dim; ++d) theta[static_cast<std::size_t>(d)] = space.Theta(d, draws.AtEnd(d, k));
    std::array<double, kMaxReported> reported{};
    info.Report(theta.data(), settings().constants, reported.data());
    for (int d = 0; d < info.num_parameters; ++d)
      table.values.push_back(reported[static_cast<std::size_t>(info.ReportedOf(d))]);
    if (space.samples_noise_scale()) table.values.push_back(std::exp(theta[static_cast<std::size_t>(space.dim - 1)]));
    table.weights.push_back(draws.weight[k]);
  }
  return table;
}

void PythonEstimator::Reset() {
  const std::lock_guard<std::mutex> lock(mutex_);
  estimator_.Reset();
  for (ModeDraws& draws : result_->modes) draws.updated = false;
  seq_ = 0;
  t_last_ = 0.0;
}

std::vector<Signal> PythonEstimator::Inputs() const {
  std::vector<Signal> inputs;
  if (settings().plant != nullptr) {
    const PlantDescription& plant = settings().plant->plant().description();
    for (const SignalDescription& signal : plant.signals)
      if (signal.name != plant.output) inputs.push_back({signal.name, signal.unit});
    return inputs;
  }
  const ModelInfo& model = *ModelOf(estimator_.plant());
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.num_inputs); ++i)
    inputs.push_back({std::string(model.compiled->inputs[i].name), std::string(model.compiled->inputs[i].unit)});
  return inputs;
}

Signal PythonEstimator::Output() const {
  if (settings().plant == nullptr) {
    const CompiledPlant& plant = *ModelOf(estimator_.plant())->compiled;
    return {std::string(plant.output.name), std::string(plant.output.unit)};
  }
  const PlantDescription& plant = settings().plant->plant().description();
  for (const SignalDescription& signal : plant.signals)
    if (signal.name == plant.output) return {signal.name, signal.unit};
  return {};
}

}  // namespace armcmc::python
