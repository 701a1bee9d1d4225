#include "armcmc/ladder/second_search.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/gap/effect_words.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/support/effect_library.hpp"
#include "armcmc/support/plant_effects.hpp"
#include "armcmc/support/plant_file.hpp"
#include "armcmc/support/plant_library.hpp"

namespace armcmc::ladder {
namespace {

constexpr double kKeptApart = 0.3;  // share of rows at the end

bool HasEverySignal(const gap::Recording& data, const PlantDescription& plant) {
  return std::all_of(plant.signals.begin(), plant.signals.end(), [&](const SignalDescription& signal) {
    return std::find(data.names.begin(), data.names.end(), signal.name) != data.names.end();
  });
}

support::Recording Described(const gap::Recording& data, const Plant& plant) {
  const PlantDescription& description = plant.description();
  support::Recording recording;
  recording.title = data.source;
  recording.model = recording.plant = description.name;
  recording.fingerprint = plant.fingerprint();
  recording.output = static_cast<std::size_t>(plant.output());
  recording.dt = data.dt;
  recording.t.assign(data.t.begin(), data.t.end());
  for (const SignalDescription& signal : description.signals) {
    const gap::Vector& column = data.Column(signal.name);
    recording.signals.push_back({signal.name, signal.unit, {column.begin(), column.end()}});
  }
  recording.runs = {0};
  recording.held_out.assign(recording.num_rows(), 0);
  const auto apart = static_cast<std::ptrdiff_t>(kKeptApart * static_cast<double>(recording.num_rows()));
  std::fill(recording.held_out.end() - apart, recording.held_out.end(), std::uint8_t{1});
  recording.notes = data.notes;
  return recording;
}

/// Translates the names of effects to those of the compiled plant.
class OwnNames {
 public:
  OwnNames(const ModelInfo& plant, const std::vector<EffectEntry>& entries) : plant_(plant), entries_(entries) {}

  void Put(std::string* name) const {
    const auto entry =
        std::find_if(entries_.begin(), entries_.end(), [&](const EffectEntry& one) { return one.name == *name; });
    if (entry != entries_.end()) *name = NameOf(*entry);
  }
  void Put(std::vector<std::string>* names) const {
    for (std::string& name : *names) Put(&name);
  }
  /// In a sentence, in which names are written as words.
  void PutInto(std::string* sentence) const {
    for (const EffectEntry& entry : entries_) {
      const std::string from = gap::EffectInSentence(entry.name), to = gap::EffectInSentence(NameOf(entry));
      const std::size_t at = from == to ? std::string::npos : sentence->find(from);
      if (at != std::string::npos) sentence->replace(at, from.size(), to);
    }
  }

 private:
  [[nodiscard]] std::string NameOf(const EffectEntry& entry) const {
    for (const std::string& alias : entry.aliases)
      if (FindEffect(plant_, alias) != nullptr) return alias;
    return entry.name;
  }

  const ModelInfo& plant_;
  const std::vector<EffectEntry>& entries_;
};

}  // namespace

std::optional<SecondSearch> SearchAgain(const gap::WorkflowRequest& request) {
  if (request.heldout || request.earlier || request.until < gap::Step::kShow) return std::nullopt;
  if (!request.diagnose.pairs || !request.diagnose.known.empty()) return std::nullopt;
  const ModelInfo& model = *CompiledModels()[static_cast<std::size_t>(FindModel(BuiltinSettings(request.model).model))];
  const support::PlantFile plant = support::ReadPlantFile(support::FindPlantFile(std::string(model.name)));
  // If the law explains a target other than the output, the plant file lacks the other equations.
  const PlantDescription& description = plant.plant.description();
  if (!description.predicts.empty() || !HasEverySignal(request.data, description)) return std::nullopt;

  DiagnosisRequest again;
  again.recording = Described(request.data, plant.plant);
  again.plant = &plant;
  again.without = request.diagnose.without;
  again.seed = request.diagnose.seed;
  if (request.progress) again.progress = request.progress;
  Diagnosis diagnosis = Diagnose(again);
  gap::Result& result = diagnosis.result;
  // A name given by few events, a tie, or one that the held-out rows contradict would be a guess.
  if (result.ladder.empty() || result.ladder.front().provisional || result.ladder.front().effects.size() > 1)
    return std::nullopt;
  if (diagnosis.ladder.complete && !result.complete) return std::nullopt;
  const std::vector<EffectEntry> entries = support::EffectsFor(plant.effects);
  const OwnNames names(model, entries);
  for (gap::EffectFinding& effect : result.effects) names.Put(&effect.name);
  for (gap::LadderRung& rung : result.ladder) names.Put(&rung.effects);
  for (gap::CandidateScore& candidate : result.candidates) names.Put(&candidate.effects);
  for (std::vector<std::string>& set : result.ambiguous_set) names.Put(&set);
  names.PutInto(&result.sentence);
  result.model = request.model;
  result.notes.insert(
      result.notes.begin(),
      "with the law assumed to be exact no effect was named; these were found when the law was allowed to err. "
      "model.toml is a plant file: armcmc-estimator --model takes it without --config");
  return SecondSearch{std::move(again.recording), std::move(diagnosis)};
}

}  // namespace armcmc::ladder
