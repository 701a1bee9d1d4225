#include "effect_tables.hpp"

#include "armcmc/support/text_table.hpp"

namespace armcmc::model {
namespace {

using support::TextTable;

std::string Joined(const std::vector<std::string>& words, const std::string& between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

/// "velocity; output force or torque".
std::string NeedsOf(const EffectForm& form) {
  std::vector<std::string> needs;
  for (const EffectNeed& need : form.needs) {
    std::string text = need.roles.empty() ? "" : Joined(need.roles, "/") + ' ';
    text += need.kind == "signal" ? "" : need.kind + ' ';
    if (!need.unit.empty()) text += "in " + need.unit + ' ';
    if (!need.rate_of.empty()) text += "rate of " + need.rate_of + ' ';
    if (text.empty()) text = "any signal ";
    text.pop_back();
    needs.push_back(std::move(text));
  }
  if (!form.explains.empty()) needs.push_back("output " + form.explains.front());
  return needs.empty() ? "nothing" : Joined(needs, ", ");
}

std::string NeedsOf(const EffectEntry& entry) {
  std::vector<std::string> all;
  for (const EffectForm& form : entry.forms)
    if (!form.variant) all.push_back(NeedsOf(form));
  return Joined(all, "; or ");
}

}  // namespace

std::string EffectsText(const std::vector<EffectEntry>& entries) {
  TextTable table({"effect", "family", "needs", "what it is"}, TextTable::Content::kWords);
  for (const EffectEntry& entry : entries) table.AddRow({entry.name, entry.family, NeedsOf(entry), entry.title});
  return table.ToString();
}

std::string FittingText(const PlantDescription& plant, const std::vector<EffectEntry>& entries) {
  TextTable table({"effect", "acts on", "variants", "why not"}, TextTable::Content::kWords);
  for (const EffectEntry& entry : entries) {
    std::vector<std::string> bound;
    std::string variants;
    for (const EffectBinding& binding : Bindings(plant, entry)) {
      const EffectForm& form = entry.forms[binding.form];
      if (form.variant && variants.find(form.name) == std::string::npos)
        variants += (variants.empty() ? "" : ", ") + form.name;
      if (form.variant) continue;
      std::vector<std::string> symbols;
      for (const auto& [need, symbol] : binding.symbols) symbols.push_back(symbol);
      bound.push_back(symbols.empty() ? plant.output : Joined(symbols, ", "));
    }
    const std::string why = WhyNot(plant, entry);
    table.AddRow({entry.name, bound.empty() ? "-" : Joined(bound, "; or "), variants.empty() ? "-" : variants,
                  why.empty() ? "-" : why});
  }
  return table.ToString();
}

}  // namespace armcmc::model
