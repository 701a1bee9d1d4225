#include "armcmc/ladder/equations.hpp"

#include <algorithm>
#include <set>

#include "armcmc/expression/syntax.hpp"
#include "free_starts.hpp"

namespace armcmc::ladder {
namespace {

using NameSet = std::set<std::string>;

void AddNames(const std::string& text, NameSet* names) {
  if (text.empty()) return;
  for (const expression::SyntaxNode& node : expression::Parse(text).nodes)
    if (node.op == expression::Op::kSymbol) names->insert(node.name);
}

/// Names of everything that laws, targets, conditions and `predicts` depend on, directly or through lets and states.
NameSet Dependencies(const PlantDescription& plant) {
  NameSet names;
  for (const std::string* text : {&plant.law, &plant.predicts}) AddNames(*text, &names);
  for (const ModeDescription& mode : plant.modes)
    for (const std::string* text : {&mode.law, &mode.target, &mode.when}) AddNames(*text, &names);
  for (std::size_t before = 0; before != names.size();) {
    before = names.size();
    for (const LetDescription& let : plant.lets)
      if (names.contains(let.name)) AddNames(let.text, &names);
    for (const StateDescription& state : plant.states) {
      if (!names.contains(state.name)) continue;
      AddNames(state.rate, &names);
      AddNames(state.start, &names);
    }
  }
  return names;
}

/// The plant without constants, parameters, lets and states that nothing depends on, and without reports, which may
/// refer to the whole plant.
PlantDescription Pruned(PlantDescription plant) {
  const NameSet names = Dependencies(plant);
  const auto keep = [&names](auto* list) {
    std::erase_if(*list, [&names](const auto& item) { return !names.contains(item.name); });
  };
  keep(&plant.constants);
  keep(&plant.parameters);
  keep(&plant.lets);
  keep(&plant.states);
  plant.reports.clear();
  return plant;
}

double SizeOf(const std::string& name, const DataScales& scales) {
  const auto found = scales.quantity.find(name);
  return found == scales.quantity.end() ? 1.0 : found->second.rms;
}

}  // namespace

PlantDescription LawEquation(const PlantDescription& plant) {
  PlantDescription law = plant;
  law.predicts.clear();
  return Pruned(std::move(law));
}

std::vector<MeasuredState> MeasuredStates(const PlantDescription& plant) {
  std::vector<MeasuredState> measured;
  for (const StateDescription& state : plant.states)
    for (const SignalDescription& signal : plant.signals) {
      if (signal.name == plant.output || signal.unit != state.unit) continue;
      if (signal.name == state.measured_by || (state.measured_by.empty() && signal.name == state.start)) {
        measured.push_back({state.name, signal.name});
        break;
      }
    }
  return measured;
}

std::optional<PlantDescription> OutputEquation(const PlantDescription& plant,
                                               const std::vector<MeasuredState>& measured, const DataScales& scales,
                                               double noise) {
  constexpr double kNoises = 3.0, kOfSize = 0.1;
  PlantDescription output = plant;
  output.predicts.clear();
  for (std::size_t m = measured.size(); m-- > 0;) {
    std::erase_if(output.states, [&](const StateDescription& state) { return state.name == measured[m].state; });
    output.lets.insert(output.lets.begin(), {measured[m].state, measured[m].signal});
  }
  output.law = plant.predicts;
  output.modes.clear();
  output = Pruned(std::move(output));
  const bool differs = std::any_of(output.parameters.begin(), output.parameters.end(),
                                   [](const ParameterDescription& p) { return p.per_mode; });
  if (differs) {
    output.modes = plant.modes;
    for (ModeDescription& mode : output.modes) {
      mode.law = output.law;
      mode.target.clear();
    }
    output.law.clear();
    PlantDescription with_modes = output;  // conditions may depend on pruned lets and constants
    with_modes.constants = plant.constants;
    with_modes.lets = plant.lets;
    for (std::size_t m = measured.size(); m-- > 0;)
      with_modes.lets.insert(with_modes.lets.begin(), {measured[m].state, measured[m].signal});
    output = Pruned(std::move(with_modes));
  }
  for (StateDescription& state : output.states)
    if (state.start == plant.output)
      FreeStart(&state, std::max(kNoises * noise, 1e-9 * SizeOf(plant.output, scales)), &output);
  if (output.parameters.empty() && !output.states.empty())
    FreeStart(&output.states.front(), kOfSize * SizeOf(output.states.front().name, scales), &output);
  if (output.parameters.empty()) return std::nullopt;
  output.noise = {};
  output.noise.std = std::max(noise, 1e-300);
  output.noise.estimate = true;
  return output;
}

}  // namespace armcmc::ladder
