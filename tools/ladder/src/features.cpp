#include "armcmc/ladder/features.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace armcmc::ladder {
namespace {

bool Moves(const Eigen::VectorXd& value) {
  return value.allFinite() && value.maxCoeff() - value.minCoeff() > 1e-9 * value.cwiseAbs().maxCoeff();
}

/// Low-pass filter within each run, which gives a function of it the recent past.
Eigen::VectorXd Past(const Dataset& data, const Eigen::VectorXd& value, double tau) {
  const double keep = std::exp(-data.series->dt / tau);
  Eigen::VectorXd past(value.size());
  std::size_t run = 0;
  for (Eigen::Index n = 0; n < value.size(); ++n) {
    const bool begins = run < data.series->runs.size() && data.series->runs[run] == static_cast<std::size_t>(n);
    if (begins) ++run;
    past[n] = begins ? value[n] : keep * past[n - 1] + (1.0 - keep) * value[n];
  }
  return past;
}

}  // namespace

bool IsExplained(const PlantDescription& plant, const std::string& signal) {
  return std::any_of(plant.modes.begin(), plant.modes.end(),
                     [&](const ModeDescription& mode) { return !mode.passive && mode.target == signal; });
}

std::vector<Feature> FeaturesOf(const identify::TrajectoryModel& model, const Eigen::VectorXd& theta) {
  const PlantDescription& plant = model.plant().description();
  std::vector<Feature> features;
  const auto add = [&](const std::string& name, const std::string& unit, Eigen::VectorXd value) {
    if (Moves(value)) features.push_back({name, unit, std::move(value)});
  };
  const auto rows = static_cast<Eigen::Index>(model.num_rows());
  for (std::size_t s = 0; s < plant.signals.size(); ++s)
    if (static_cast<int>(s) != model.plant().output() && !IsExplained(plant, plant.signals[s].name))
      add(plant.signals[s].name, plant.signals[s].unit,
          Eigen::Map<const Eigen::VectorXd>(model.series().signals[s].data(), rows));
  if (!plant.states.empty()) {
    const Eigen::MatrixXd states = model.States(theta);
    for (std::size_t s = 0; s < plant.states.size(); ++s)
      add(plant.states[s].name, plant.states[s].unit, states.col(static_cast<Eigen::Index>(s)));
  }
  return features;
}

Eigen::MatrixXd FlexibleFeatures(const Dataset& data, const std::vector<Feature>& features,
                                 const std::vector<Eigen::Index>& active_rows, double period, int count) {
  std::vector<Eigen::VectorXd> columns;
  for (const Feature& feature : features) {
    columns.push_back(feature.value);
    for (const double tau : {0.03 * period, 0.3 * period})
      if (tau > data.series->dt) columns.push_back(feature.value - Past(data, feature.value, tau));
  }
  std::vector<Eigen::VectorXd> standard;
  for (const Eigen::VectorXd& column : columns) {
    Eigen::VectorXd x = column(active_rows);
    x.array() -= x.mean();
    const double size = std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
    if (size > 0.0) standard.emplace_back(x / size);
  }
  std::mt19937_64 random(20200607);
  const auto uniform = [&] { return (static_cast<double>(random() >> 11U) + 0.5) * 0x1p-53; };
  const auto normal = [&] {
    return std::sqrt(-2.0 * std::log(uniform())) * std::cos(2.0 * std::numbers::pi * uniform());
  };
  Eigen::MatrixXd out(static_cast<Eigen::Index>(active_rows.size()), count);
  for (Eigen::Index c = 0; c < count; ++c) {
    Eigen::VectorXd phase = Eigen::VectorXd::Constant(out.rows(), 2.0 * std::numbers::pi * uniform());
    // Few quantities in each basis function: a random function of eight at once fits noise.
    const double reach = std::sqrt(2.0 / std::max<double>(2.0, static_cast<double>(standard.size())));
    for (const Eigen::VectorXd& x : standard) phase += reach * normal() * x;
    out.col(c) = std::sqrt(2.0 / count) * phase.array().cos();
  }
  return out;
}

}  // namespace armcmc::ladder
