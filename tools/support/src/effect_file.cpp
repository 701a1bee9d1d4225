#include "armcmc/support/effect_file.hpp"

#include <limits>

#include "armcmc/support/csv.hpp"
#include "description_tables.hpp"
#include "placed_error.hpp"

namespace armcmc::support {
namespace {

/// A size: a text, or a plain number.
std::string Size(StrictTable* table, std::string_view key) {
  if (!table->Has(key) || table->IsText(key)) return table->Text(key, "");
  constexpr double kInf = std::numeric_limits<double>::infinity();
  return ExactNumber(table->RequiredNumber(key, -kInf, kInf));
}

EffectTerm ReadTerm(StrictTable* at) {
  EffectTerm term;
  term.slot = at->Choice("slot", "output", {"output", "law", "rate", "input", "parameter"});
  term.of = at->Text("of", "");
  term.formula = at->RequiredText("formula");
  return term;
}

void ReadNeeds(StrictTable needs, EffectForm* form) {
  for (const std::string& name : needs.Keys()) {
    StrictTable at = needs.Table(name);
    EffectNeed need;
    need.name = name;
    need.kind = at.Choice("kind", "signal", {"signal", "state", "parameter", "constant"});
    need.roles = at.Texts("role");
    need.unit = at.Text("unit", "");
    need.per = at.Text("per", "");
    need.reads = at.Text("reads", "");
    need.rate_of = at.Text("rate_of", "");
    need.used = at.Boolean("used", false);
    form->needs.push_back(std::move(need));
  }
}

void ReadNumbers(StrictTable* table, EffectForm* form) {
  StrictTable constants = table->Table("constants");
  for (const std::string& name : constants.Keys()) {
    StrictTable at = constants.Table(name);
    form->constants.push_back({name, at.RequiredText("unit"), Size(&at, "value")});
  }
  StrictTable parameters = table->Table("parameters");
  for (const std::string& name : parameters.Keys()) {
    StrictTable at = parameters.Table(name);
    EffectParameter p;
    p.name = name;
    p.unit = at.RequiredText("unit");
    p.prior = at.Choice("prior", "normal", {"normal", "uniform", "lognormal"});
    if (at.Has("mean")) p.mean = Size(&at, "mean");
    p.sd = Size(&at, "sd");
    p.lower = Size(&at, "lower");
    p.upper = Size(&at, "upper");
    p.none = Size(&at, "none");
    form->parameters.push_back(std::move(p));
  }
}

EffectForm ReadForm(StrictTable* table) {
  EffectForm form;
  form.explains = table->Texts("explains");
  form.terms.push_back(ReadTerm(table));
  for (StrictTable& at : table->Tables("also")) form.terms.push_back(ReadTerm(&at));
  form.online = table->Boolean("online", true);
  form.reason = table->Text("reason", "");
  ReadNeeds(table->Table("needs"), &form);
  ReadNumbers(table, &form);
  form.lets = ReadLets(table);
  StrictTable states = table->Table("states");
  for (const std::string& name : states.Keys()) {
    StrictTable at = states.Table(name);
    form.states.push_back(ReadState(&at, name));
  }
  return form;
}

EffectEntry ReadEntry(StrictTable* table) {
  EffectEntry entry;
  entry.name = table->RequiredText("name");
  entry.aliases = table->Texts("aliases");
  entry.title = table->RequiredText("title");
  entry.family = table->RequiredText("family");
  entry.kin = table->Texts("kin");
  entry.single = table->Boolean("single", false);
  entry.resists = table->Boolean("resists", false);
  entry.experiment = table->Text("experiment", "");
  entry.forms.push_back(ReadForm(table));
  for (StrictTable& at : table->Tables("form")) entry.forms.push_back(ReadForm(&at));
  for (StrictTable& at : table->Tables("variant")) {
    const std::string name = at.RequiredText("name");
    const std::string title = at.RequiredText("title");
    EffectForm variant = ReadForm(&at);
    variant.name = name;
    variant.title = title;
    variant.variant = true;
    entry.forms.push_back(std::move(variant));
  }
  for (const EffectForm& form : entry.forms)
    if (!form.online && form.reason.empty())
      throw table->Error("online", "a form that the estimator cannot run says why: reason = \"..\"");
  return entry;
}

EffectEntry Whole(StrictTable root) {
  root.RequireSchema();
  EffectEntry entry = ReadEntry(&root);
  root.Finish();
  try {
    CheckEffect(entry);
  } catch (const PlantError& error) {
    throw PlacedError(root, error);
  }
  return entry;
}

}  // namespace

EffectEntry ReadEffect(const std::filesystem::path& path) { return Whole(StrictTable::FromFile(path)); }

EffectEntry EffectFromText(std::string_view text, std::string_view name) {
  return Whole(StrictTable::FromText(text, name));
}

EffectEntry EffectFromTable(StrictTable table) {
  EffectEntry entry = ReadEntry(&table);
  try {
    CheckEffect(entry);
  } catch (const PlantError& error) {
    throw PlacedError(table, error);
  }
  return entry;
}

}  // namespace armcmc::support
