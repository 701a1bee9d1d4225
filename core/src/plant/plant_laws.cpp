// The modes, states and reports of a plant, in terms of its names.

#include <algorithm>

#include "armcmc/expression/unit.hpp"
#include "armcmc/plant/held.hpp"
#include "armcmc/plant/plant.hpp"

namespace armcmc {

using expression::SymbolKind;
using expression::Unit;

void Plant::AddModes() {
  auto& modes = description_.modes;
  // The same as in the description of a plant that was read before.
  if (modes.size() == 1 && modes[0].name == "always" && modes[0].law == description_.law) modes.clear();
  if (modes.empty()) {
    if (description_.law.empty()) throw PlantError("law", 0, "expected a law, or modes that have one");
    ModeDescription only;
    only.name = "always";
    only.law = description_.law;
    modes.push_back(std::move(only));
  } else if (!description_.law.empty()) {
    throw PlantError("law", 0, "a plant has either a law or modes");
  }
  if (modes.size() > static_cast<std::size_t>(kMaxPlantModes))
    throw PlantError("mode", 0, "at most " + std::to_string(kMaxPlantModes) + " modes are possible");
  const bool one_law = !description_.law.empty();
  const std::optional<Unit> output_unit = scope_.Find(description_.output)->unit;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const ModeDescription& mode = modes[m];
    const std::string key = "mode[" + std::to_string(m) + "].";
    PlantMode understood;
    understood.name = mode.name;
    understood.passive = mode.passive;
    for (std::size_t other = 0; other < m; ++other)
      if (modes[other].name == mode.name)
        throw PlantError(key + "name", 0, "two modes are called \"" + mode.name + '"');
    if (!mode.when.empty()) {
      const Lowered when = Lower(key + "when", mode.when);
      if (!when.meaning.condition)
        throw PlantError(key + "when", 1, "expected a condition such as x >= 0, found a number");
      if (when.meaning.sampled)
        throw PlantError(key + "when", 1, "a mode is decided by signals alone, not by a parameter or a state");
      understood.when = when.node;
    }
    understood.target = NodeOf(SymbolKind::kSignal, output_);
    understood.target_unit = output_unit;
    if (!mode.target.empty()) {
      const Lowered target = Lower(key + "target", mode.target, {}, "", mode.when);
      if (target.meaning.sampled)
        throw PlantError(key + "target", 1,
                         "a target is computed from signals alone: what depends on a parameter belongs into the law");
      understood.target = target.node;
      understood.target_unit = target.meaning.unit;
    }
    if (mode.law.empty() && !mode.passive)
      throw PlantError(key + "law", 0, "expected a law; only a passive mode may be without");
    const std::string law_key = one_law ? "law" : key + "law";
    const auto expected = mode.passive ? output_unit : understood.target_unit;
    understood.law =
        mode.law.empty() ? graph_.Number(0.0) : Lower(law_key, mode.law, expected, "the law", mode.when).node;
    modes_.push_back(std::move(understood));
  }
  if (std::all_of(modes_.begin(), modes_.end(), [](const PlantMode& mode) { return mode.passive; }))
    throw PlantError("mode", 0, "every mode is passive: nothing could be learnt");
}

void Plant::AddRates() {
  for (const StateDescription& state : description_.states) {
    const std::string key = "states." + state.name + ".";
    const std::optional<Unit> unit = scope_.Find(state.name)->unit;
    PlantState understood;
    if (state.rate.empty()) throw PlantError(key + "rate", 0, "a state needs a rate");
    if (state.start.empty()) throw PlantError(key + "start", 0, "a state needs a start");
    if (state.substeps < 1 || state.substeps > 100)
      throw PlantError(key + "substeps", 0, "expected a number of substeps in [1, 100]");
    const Lowered rate =
        Lower(key + "rate", state.rate, unit ? std::optional(unit->Over(*scope_.Find("t")->unit)) : std::nullopt,
              "the rate of " + state.name);
    understood.rate = rate.node;
    const Lowered start = Lower(key + "start", state.start, unit, "the start of " + state.name);
    for (std::size_t s = 0; s < description_.states.size(); ++s)
      if (graph_.DependsOn(start.node, NodeOf(SymbolKind::kState, static_cast<int>(s))))
        throw PlantError(key + "start", 1, "a start depends on signals and parameters, not on states");
    understood.start = start.node;
    if (!state.measured_by.empty()) {
      understood.measured_by = SignalAt(key + "measured_by", state.measured_by);
      const auto measured = scope_.Find(state.measured_by)->unit;
      if (unit && measured && !unit->Same(*measured))
        throw PlantError(key + "measured_by", 0,
                         state.measured_by + " is " + measured->Text() + ", " + state.name + " is " + unit->Text());
    }
    states_.push_back(understood);
  }
}

void Plant::AddReports() {
  if (!description_.predicts.empty())
    predicts_ =
        Lower("predicts", description_.predicts, scope_.Find(description_.output)->unit, "what is predicted").node;
  for (const ReportDescription& report : description_.reports) {
    const std::string key = "report." + report.name;
    const Lowered lowered = Lower(key + ".value", report.value, UnitAt(key + ".unit", report.unit), report.name);
    if (graph_.at(lowered.node).varies)
      throw PlantError(key + ".value", 1, "a reported quantity is made of parameters and constants");
    reports_.push_back(lowered.node);
  }
}

void Plant::UseHeldForms() {
  HeldForms forms(&graph_, HeldSignals(description_));
  const auto at_samples = [&](int* node) {
    if (*node >= 0) *node = forms.AtSamples(*node);
  };
  for (PlantMode& mode : modes_)
    for (int* node : {&mode.when, &mode.law, &mode.target}) at_samples(node);
  at_samples(&predicts_);
  for (PlantState& state : states_) {
    at_samples(&state.start);
    state.rate = forms.BetweenSamples(state.rate);
  }
}

void Plant::CheckParametersHaveInfluence() const {
  for (std::size_t d = 0; d < description_.parameters.size(); ++d) {
    const std::string& name = description_.parameters[d].name;
    const std::string key = "parameters." + name;
    if (mentions_.count(name) == 0) throw PlantError(key, 0, name + " is not used: remove it, or use it in the law");
    const int node = NodeOf(SymbolKind::kParameter, static_cast<int>(d));
    std::vector<int> felt;
    for (const PlantMode& mode : modes_)
      if (!mode.passive) felt.push_back(mode.law);
    // The prediction is compared with the output as well.
    if (predicts_ >= 0) felt.push_back(predicts_);
    // Through the states that a law reads, and their dependencies.
    for (std::size_t round = 0; round <= states_.size(); ++round)
      for (std::size_t s = 0; s < states_.size(); ++s) {
        const int state = NodeOf(SymbolKind::kState, static_cast<int>(s));
        const bool read = std::any_of(felt.begin(), felt.end(), [&](int n) { return graph_.DependsOn(n, state); });
        if (read && std::find(felt.begin(), felt.end(), states_[s].rate) == felt.end()) {
          felt.push_back(states_[s].rate);
          felt.push_back(states_[s].start);
        }
      }
    if (std::none_of(felt.begin(), felt.end(), [&](int n) { return graph_.DependsOn(n, node); }))
      throw PlantError(key, 0, "no law depends on " + name + ": data cannot determine it");
  }
}

}  // namespace armcmc
