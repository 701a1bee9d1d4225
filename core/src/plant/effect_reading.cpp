#include "effect_reading.hpp"

#include <algorithm>
#include <set>

#include "armcmc/expression/operation.hpp"
#include "effect_text.hpp"

namespace armcmc {
namespace {

/// The names in the texts, and in the lets that they use.
std::set<std::string> Reached(const PlantDescription& plant, const std::vector<std::string>& texts) {
  std::set<std::string> names;
  for (const std::string& text : texts)
    for (std::string& name : NamesIn(text)) names.insert(std::move(name));
  // A let uses those above it only.
  for (std::size_t l = plant.lets.size(); l-- > 0;)
    if (names.contains(plant.lets[l].name))
      for (std::string& name : NamesIn(plant.lets[l].text)) names.insert(std::move(name));
  return names;
}

bool HasMemory(std::string_view text) {
  for (const std::string& name : NamesIn(text))
    for (const expression::OpInfo& op : expression::kOps)
      if (op.memory && op.name == name) return true;
  return false;
}

}  // namespace

PlantDescription AsWritten(PlantDescription plant) {
  if (!plant.law.empty()) plant.modes.clear();
  return plant;
}

bool ExplainsOutput(const PlantDescription& plant) {
  if (!plant.predicts.empty() || !plant.law.empty()) return true;
  return std::all_of(plant.modes.begin(), plant.modes.end(), [](const auto& mode) { return mode.target.empty(); });
}

bool MayMerge(const PlantDescription& plant) {
  if (!plant.law.empty()) return true;
  return plant.predicts.empty() && ExplainsOutput(plant) &&
         std::none_of(plant.parameters.begin(), plant.parameters.end(), [](const auto& p) { return p.per_mode; });
}

std::string MergedLaw(const PlantDescription& plant) {
  if (!plant.law.empty()) return plant.law;
  std::string law = "0";
  for (std::size_t m = plant.modes.size(); m-- > 0;) {
    const ModeDescription& mode = plant.modes[m];
    const std::string own = mode.law.empty() ? "0" : mode.law;
    law = mode.when.empty() ? own : "if(" + mode.when + ", " + own + ", " + law + ')';
  }
  return law;
}

bool LawReads(const PlantDescription& plant, const std::string& name) {
  std::vector<std::string> texts{plant.law, plant.predicts};
  for (const ModeDescription& mode : plant.modes) {
    if (mode.passive) continue;
    texts.push_back(mode.law);
    texts.push_back(mode.target);
  }
  for (std::size_t round = 0; round <= plant.states.size(); ++round) {
    const std::set<std::string> names = Reached(plant, texts);
    if (names.contains(name)) return true;
    for (const StateDescription& state : plant.states)
      if (names.contains(state.name)) texts.push_back(state.rate);
  }
  return false;
}

std::string WithoutLets(const PlantDescription& plant, std::string text) {
  for (std::size_t l = plant.lets.size(); l-- > 0;)
    if (Mentions(text, plant.lets[l].name)) text = Inserted(text, {{plant.lets[l].name, plant.lets[l].text}});
  return text;
}

bool RateReads(const PlantDescription& plant, const std::string& state, const std::string& name) {
  for (const StateDescription& s : plant.states)
    if (s.name == state) return Reached(plant, {s.rate}).contains(name);
  return false;
}

bool NeedsOneLaw(const EffectForm& form) {
  const auto says = [](const std::string& text) { return Mentions(text, "law"); };
  for (const LetDescription& let : form.lets)
    if (says(let.text)) return true;
  for (const StateDescription& state : form.states)
    if (says(state.rate) || says(state.start)) return true;
  for (const EffectTerm& term : form.terms)
    if ((term.slot == "output" || term.slot == "law") && says(term.formula) && HasMemory(term.formula)) return true;
  return false;
}

std::string KeyOfForm(const EffectEntry& entry, std::size_t form) {
  if (form == 0) return "";
  std::size_t before = 0;
  const bool variant = entry.forms[form].variant;
  for (std::size_t f = 1; f < form; ++f) before += entry.forms[f].variant == variant ? 1U : 0U;
  return (variant ? "variant[" : "form[") + std::to_string(before) + "].";
}

std::string KeyOfTerm(std::size_t term) {
  return term == 0 ? "formula" : "also[" + std::to_string(term - 1) + "].formula";
}

}  // namespace armcmc
