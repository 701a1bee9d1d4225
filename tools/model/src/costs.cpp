#include "costs.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/settings.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/text_table.hpp"

namespace armcmc::model {
namespace {

constexpr std::size_t kPacks = 25, kFewest = 3, kSamples = 100;

/// Waves about 1, so that roots and powers have a value; each signal at a frequency of its own.
std::shared_ptr<const support::Recording> MadeUp(const Plant& plant) {
  constexpr double kDt = 1e-3;
  auto recording = std::make_shared<support::Recording>();
  recording->plant = plant.description().name;
  recording->fingerprint = plant.fingerprint();
  recording->output = static_cast<std::size_t>(plant.output());
  recording->dt = kDt;
  recording->runs = {0};
  double frequency = 7.0;
  for (const SignalDescription& signal : plant.description().signals) {
    recording->signals.push_back({signal.name, signal.unit, {}});
    for (std::size_t n = 0; n < kPacks * kSamples; ++n)
      recording->signals.back().value.push_back(1.0 + std::sin(frequency * kDt * static_cast<double>(n)));
    frequency += 3.0;
  }
  for (std::size_t n = 0; n < kPacks * kSamples; ++n) recording->t.push_back(kDt * static_cast<double>(n));
  recording->held_out.assign(recording->t.size(), 0);
  return recording;
}

struct Step {
  double ms = 0.0;            ///< Median of the adjust computation.
  int draws = 0;              ///< Most that a pack had.
  double log_evidence = 0.0;  ///< Of all packs, each from what the ones before tell.
};

/// Over the first packs of a recording; nothing where it has none, or where they were refused.
std::optional<Step> TimeSteps(const std::shared_ptr<const PlantProgram>& program,
                              const std::shared_ptr<const support::Recording>& recording) {
  replay::SourceRequest request;
  request.described = program;
  request.recording = recording;
  request.num_inputs = program->info().num_inputs;
  request.period = static_cast<double>(kSamples) * recording->dt;
  std::unique_ptr<replay::PackSource> source;
  try {
    source = replay::OpenSource(request);
  } catch (const support::InputError&) {
    return std::nullopt;  // no whole pack
  }
  Estimator estimator(DescribedSettings(program));
  const auto result = estimator.MakeResult();
  Estimate estimate;
  std::vector<double> ms;
  Step step;
  replay::RecordedPack next;
  while (ms.size() < kPacks && source->Next(&next)) {
    const auto start = std::chrono::steady_clock::now();
    const Status status = estimator.Adjust(next.pack, std::numeric_limits<Nanos>::max(), ClockRef(), result.get());
    ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    if (status == Status::kBadPack || status == Status::kNonFinite) return std::nullopt;
    if (status == Status::kHeld) ms.pop_back();
    estimator.Execute(*result, &estimate);
    for (int m = 0; m < estimate.num_modes; ++m) {
      const ModeEstimate& mode = estimate.modes[static_cast<std::size_t>(m)];
      step.draws = std::max(step.draws, mode.draws);
      if (mode.updated) step.log_evidence += mode.log_evidence;
    }
  }
  if (ms.size() < kFewest) return std::nullopt;
  const auto middle = ms.begin() + static_cast<std::ptrdiff_t>(ms.size() / 2);
  std::nth_element(ms.begin(), middle, ms.end());
  step.ms = *middle;
  return step;
}

}  // namespace

std::string BetweenText(const std::shared_ptr<const PlantProgram>& program,
                        const std::shared_ptr<const support::Recording>& recording) {
  constexpr double kWorthSaying = 20.0;  // nats
  const std::optional<Step> own = program->states().size() > 0 ? TimeSteps(program, recording) : std::optional<Step>();
  if (!own) return "";
  std::string text;
  const PlantDescription& description = program->plant().description();
  for (std::size_t s = 0; s < description.signals.size(); ++s) {
    if (static_cast<int>(s) == program->plant().output()) continue;
    std::string best;
    double most = kWorthSaying;
    for (const char* between : {"linear", "held", "smooth"}) {
      PlantDescription other = description;
      if (std::exchange(other.signals[s].between, between) == between) continue;
      const std::optional<Step> step =
          TimeSteps(std::make_shared<const PlantProgram>(std::make_shared<const Plant>(std::move(other))), recording);
      const double more = step ? step->log_evidence - own->log_evidence : 0.0;
      if (!(more > most)) continue;
      best = between;
      most = more;
    }
    if (best.empty()) continue;
    const std::string& name = description.signals[s].name;
    text.append("between samples: ").append(name).append(" with between = \"").append(best);
    text.append("\" explains these data better, by ").append(support::Significant(most, 3)).append(" nats\n");
  }
  return text;
}

std::string CostText(const std::shared_ptr<const PlantProgram>& program,
                     const std::shared_ptr<const support::Recording>& recording) {
  std::string text = "costs: ";
  for (int m = 0; m < program->info().num_modes; ++m) {
    int largest = 0;
    for (const expression::Tape& law : program->laws(m)) largest = std::max(largest, law.size());
    text += (m > 0 ? ", " : "") + std::to_string(largest);
    if (program->info().num_modes > 1) text += " in " + std::string(program->info().modes[static_cast<std::size_t>(m)]);
  }
  text += " operations a candidate and sample";
  if (const PlantStates& states = program->states(); states.size() > 0)
    text += ", and " + std::to_string(states.substeps() * states.step().size()) + " for the states";
  text += "; " + std::to_string(program->num_scalars()) + " quantities of the signals once a sample\n";

  std::optional<Step> step;
  if (recording != nullptr) step = TimeSteps(program, recording);
  const bool recorded = step.has_value();
  if (!recorded) step = TimeSteps(program, MadeUp(program->plant()));
  if (!step && recording != nullptr) return text + "step: not measured, the law has no value for these data's packs\n";
  if (!step) return text + "step: not measured, the law has no value for signals about 1; give --data\n";
  return text + "step: " + support::Significant(step->ms, 3) + " ms on this computer for " +
         std::to_string(step->draws) + " draws and " + std::to_string(kSamples) + " samples, " +
         (recorded ? "over these data\n" : "over synthetic signals\n");
}

}  // namespace armcmc::model
