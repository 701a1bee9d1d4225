#include "hidden.hpp"

#include <algorithm>
#include <armcmc/support/strict_toml.hpp>

namespace armcmc::embedded {
std::string_view HiddenCases() noexcept;
}  // namespace armcmc::embedded

namespace armcmc::gap_bench {
namespace {

using support::StrictTable;

Hidden ReadHidden(StrictTable table) {
  Hidden hidden;
  hidden.rich = table.RequiredText("rich");
  hidden.paper = table.Text("paper", "");
  hidden.catalogue = table.Texts("catalogue");
  hidden.variants = table.Texts("variants");
  hidden.outside = table.Texts("outside");
  hidden.taken_for_granted = table.Texts("taken_for_granted");
  StrictTable names = table.Table("also_called");
  for (const std::string& name : names.Keys()) hidden.also_called[name] = names.Texts(name);
  return hidden;
}

HiddenEffects Read() {
  StrictTable root = StrictTable::FromText(embedded::HiddenCases(), "cases.toml");
  root.RequireSchema();
  HiddenEffects effects{ReadHidden(root.Table("contact")), ReadHidden(root.Table("actuator")), {}};
  for (StrictTable& table : root.Tables("equation"))
    effects.felt.push_back({table.RequiredText("name"), table.Texts("only"), table.Texts("all_but")});
  root.Finish();
  return effects;
}

bool Has(const std::vector<std::string>& list, std::string_view one) {
  return std::find(list.begin(), list.end(), one) != list.end();
}

}  // namespace

bool HiddenEffects::Changes(std::string_view effect, std::string_view equation) const {
  return std::any_of(felt.begin(), felt.end(), [&](const Felt& one) {
    return one.equation == equation && (one.only.empty() ? !Has(one.all_but, effect) : Has(one.only, effect));
  });
}

const HiddenEffects& WhatIsHidden() {
  static const HiddenEffects effects = Read();
  return effects;
}

}  // namespace armcmc::gap_bench
