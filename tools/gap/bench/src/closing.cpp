#include "closing.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/equation.hpp"
#include "armcmc/gap/fit.hpp"
#include "armcmc/gap/recording.hpp"
#include "armcmc/gap/verify.hpp"
#include "armcmc/gap_bench/scenario_text.hpp"

namespace armcmc::gap_bench {
namespace {

constexpr double kDiagnosed = 0.7;  // of the recording
constexpr double kShows = 0.3;      // rms over noise of what there is to close

double Squared(double value) { return value * value; }

/// Squared error of the base model on the rows kept apart.
double BaseError(const gap::Equation& equation, const gap::Recording& recording) {
  const auto rows = static_cast<Eigen::Index>(kDiagnosed * static_cast<double>(recording.rows()));
  const gap::Diagnosis diagnosis = gap::CompareOnly(equation, recording.Slice(0, rows));
  const gap::HeldOut heldout(equation, *diagnosis.wide, recording, rows);
  return Squared(heldout.Judge(heldout.Try(diagnosis.finding.base->fit)).rmse);
}

}  // namespace

std::optional<double> FirstRung(const PlantProcess& plant, const Outcome& outcome, const std::string& scenario) {
  const std::vector<gap::LadderRung>& ladder = outcome.answer.result.ladder;
  const std::vector<std::string> outputs = OutputsOf(outcome.what.model);
  if (ladder.empty() || outputs.size() != 1) return std::nullopt;
  Truth rest = outcome.truth;
  std::erase_if(rest.effects, [](const TrueEffect& effect) { return effect.kind != "outside"; });
  const bool several = outcome.truth.effects.size() - rest.effects.size() > 1;
  gap::Recording recording =
      gap::ReadRecording(plant.Recording(outcome.what), gap::ColumnsOf(outcome.what.model), false);
  const auto column = std::find(recording.names.begin(), recording.names.end(), outputs.front());
  const std::vector<double> without =
      plant.Outputs(outcome.what, WithoutTables(scenario, "hidden_effect") + EffectTables(rest, true)).front();
  recording.columns[static_cast<std::size_t>(column - recording.names.begin())] =
      Eigen::Map<const gap::Vector>(without.data(), static_cast<Eigen::Index>(without.size()));
  const double before = Squared(outcome.answer.result.gap.before.rmse);
  const double after = Squared((several ? ladder.back() : ladder.front()).heldout_error);
  const double truth = BaseError(*gap::MakeEquation(outcome.what.model), recording);
  if (before - truth < Squared(kShows * outcome.truth.noise_sd.front())) return std::nullopt;
  return (before - after) / (before - truth);
}

double ModelError(const PlantProcess& plant, const Outcome& outcome, const std::string& scenario) {
  constexpr int kSmooth = 1, kSteps = 30;  // without noise there is nothing to smooth
  const gap::Recording whole = plant.Rerun(outcome.what, WithoutTables(scenario, "noise."));
  const gap::Recording clean =
      whole.Slice(0, static_cast<Eigen::Index>(kDiagnosed * static_cast<double>(whole.rows())));
  const auto equations = gap::MakeEquations(outcome.what.model);
  double most = 0.0;
  for (std::size_t k = 0; k < equations.size(); ++k) {
    const gap::Signals signals = equations[k]->Prepare(clean, kSmooth);
    const gap::Fitter fitter(*equations[k], signals, gap::Whitener{});
    const gap::Fitted fit = fitter.Fit({}, equations[k]->Start(signals), kSteps);
    const double square = (signals.output - fit.predicted).squaredNorm() / static_cast<double>(signals.rows());
    most = std::max(most, std::sqrt(square) / outcome.truth.noise_sd[k]);
  }
  return most;
}

}  // namespace armcmc::gap_bench
