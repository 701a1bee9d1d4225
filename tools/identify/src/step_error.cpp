#include "armcmc/identify/step_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace armcmc::identify {
namespace {

constexpr int kMostSubsteps = 100;  // that a plant file may ask for
constexpr double kDiverged = 1e6;   // of the noise
constexpr double kShare = 0.1;      // of the noise
constexpr std::size_t kRun = 200, kMostRows = 4000;

/// The beginning of the series, in short runs.
std::shared_ptr<const Series> ShortRuns(const Series& series) {
  auto part = std::make_shared<Series>();
  part->dt = series.dt;
  const std::size_t rows = std::min(series.num_rows(), kMostRows);
  part->t.assign(series.t.begin(), series.t.begin() + static_cast<std::ptrdiff_t>(rows));
  for (const auto& signal : series.signals)
    part->signals.emplace_back(signal.begin(), signal.begin() + static_cast<std::ptrdiff_t>(rows));
  for (std::size_t r = 0; r < series.runs.size() && series.runs[r] < rows; ++r) {
    const std::size_t end = r + 1 < series.runs.size() ? std::min(series.runs[r + 1], rows) : rows;
    for (std::size_t first = series.runs[r]; first < end; first += kRun) part->runs.push_back(first);
  }
  return part;
}

/// The law with so many substeps; not finite somewhere: nothing.
std::optional<Eigen::VectorXd> Predicted(const Plant& plant, const std::shared_ptr<const Series>& series,
                                         const Eigen::VectorXd& theta, int substeps) {
  PlantDescription description = plant.description();
  for (StateDescription& state : description.states) state.substeps = substeps;
  const TrajectoryModel model(std::make_shared<const Plant>(std::move(description)), series);
  Eigen::VectorXd prediction;
  if (!model.PredictOne(theta, &prediction)) return std::nullopt;
  return prediction;
}

std::string Short(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g", value);
  return text;
}

}  // namespace

StepError StepErrorOf(const Plant& plant, const Series& series, const Eigen::VectorXd& theta, double noise_sd) {
  StepError error;
  if (plant.description().states.empty()) return error;
  for (const StateDescription& state : plant.description().states)
    error.substeps = std::max(error.substeps, state.substeps);
  const std::shared_ptr<const Series> part = ShortRuns(series);
  std::optional<Eigen::VectorXd> now = Predicted(plant, part, theta, error.substeps);
  if (2 * error.substeps > kMostSubsteps) return error;  // nothing is finer
  for (int substeps = error.substeps; !error.enough && 2 * substeps <= kMostSubsteps; substeps *= 2) {
    std::optional<Eigen::VectorXd> finer = Predicted(plant, part, theta, 2 * substeps);
    const double change = now && finer ? std::sqrt((*now - *finer).squaredNorm() / static_cast<double>(now->size()))
                                       : std::numeric_limits<double>::infinity();
    if (substeps == error.substeps) error.change = change;
    if (change <= kShare * noise_sd) error.enough = substeps;
    now = std::move(finer);
  }
  error.short_enough = error.enough == error.substeps;
  return error;
}

std::string StepErrorText(const StepError& error, double dt, double noise_sd) {
  if (error.short_enough) return "";
  std::string text = "the states change too fast for " +
                     (error.substeps == 1 ? std::string("one step") : std::to_string(error.substeps) + " steps") +
                     " every " + Short(dt) + " s: ";
  text += error.change < kDiverged * noise_sd ? "with steps half as long the law differs by " + Short(error.change) +
                                                    " (rms), its noise being " + Short(noise_sd)
                                              : "their integration diverges";
  if (error.enough)
    return text + "; write substeps = " + std::to_string(*error.enough) + " or more in [states], and look again\n";
  return text + "; " + std::to_string(kMostSubsteps / 2) +
         " substeps are not enough either: replace the fast state by the value at which it settles\n";
}

}  // namespace armcmc::identify
