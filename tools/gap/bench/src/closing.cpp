#include "closing.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/equation.hpp"
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

}  // namespace armcmc::gap_bench
