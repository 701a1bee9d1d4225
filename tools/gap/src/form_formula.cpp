#include "form_formula.hpp"

#include <algorithm>
#include <stdexcept>

#include "armcmc/expression/check.hpp"
#include "armcmc/support/effect_library.hpp"

namespace armcmc::gap {
namespace {

using expression::Op;
using expression::Scope;
using expression::SymbolKind;

void Add(const std::string& name, SymbolKind kind, int index, Scope* scope, double value = 0.0) {
  expression::Symbol symbol;
  symbol.name = name;
  symbol.kind = kind;
  symbol.index = index;
  symbol.value = value;
  scope->Add(std::move(symbol));
}

/// The slot of the catalogue in which an effect acts alike.
std::string CatalogueSlot(const std::string& slot) {
  if (slot == "drive") return "input";
  return slot == "elastic" ? "output" : slot;
}

}  // namespace

const armcmc::EffectForm& CatalogueForm(const support::StrictTable& table, const std::string& takes,
                                        const std::string& slot) {
  static const std::vector<EffectEntry> library = support::ReadEffectLibrary();
  const std::size_t slash = std::min(takes.find('/'), takes.size());
  const std::string variant = slash < takes.size() ? takes.substr(slash + 1) : "";
  const EffectEntry& entry = support::FindEffect(library, takes.substr(0, slash), table.Name() + ": takes: ");
  for (const armcmc::EffectForm& form : entry.forms)
    if (form.name == variant && form.variant == !variant.empty() && form.terms.size() == 1 &&
        form.terms.front().slot == slot)
      return form;
  throw table.Error("takes", "the effect has no such form of the slot \"" + slot + "\" with one term");
}

FormFormula::FormFormula(support::StrictTable* table, const std::vector<Coordinate>& coordinates,
                         const Signals& signals, const std::map<std::string, double>& constants)
    : table_(table) {
  const bool simulated = table->Text("slot", "") == "rate";
  Add("dt", SymbolKind::kInterval, 0, &scope_);
  // A recording has its own; a motion is that of one recording.
  if (simulated)
    Add("origin", SymbolKind::kConstant, 0, &scope_, signals.origin);
  else
    Add("origin", SymbolKind::kParameter, kFirstValue + static_cast<int>(coordinates.size()), &scope_);
  for (int i = 0; i < kNumFormSignals; ++i)
    Add(kFormSignals[static_cast<std::size_t>(i)], SymbolKind::kSignal, i, &scope_);
  for (const auto& [name, value] : constants) Add(name, SymbolKind::kConstant, 0, &scope_, value);
  for (std::size_t c = 0; c < coordinates.size(); ++c) {
    if (scope_.Find(coordinates[c].name) != nullptr)
      throw table->Error("shapes", "\"" + coordinates[c].name + "\" is a name already");
    Add(coordinates[c].name, SymbolKind::kParameter, kFirstValue + static_cast<int>(c), &scope_);
  }
  if (table->Has("takes"))
    Adopt(CatalogueForm(*table, table->RequiredText("takes"), CatalogueSlot(table->RequiredText("slot"))));
  else
    ReadOwn();
}

int FormFormula::Lower(const std::string& key, const std::string& text, const Scope& scope) {
  try {
    const expression::Syntax syntax = expression::Parse(text);
    (void)expression::Check(syntax, scope);
    return graph_.Lower(syntax, scope, lets_);
  } catch (const expression::Error& error) {
    throw table_->Error(key, "\"" + text + "\", column " + std::to_string(error.column()) + ": " + error.what());
  }
}

void FormFormula::ReadOwn() {
  support::StrictTable lets = table_->Table("let"), states = table_->Table("states");
  const std::vector<std::string> names = states.Keys();
  for (std::size_t k = 0; k < names.size(); ++k)
    Add(names[k], SymbolKind::kState, kFirstState + static_cast<int>(k), &scope_);
  for (const std::string& name : lets.Keys()) {
    const int node = Lower("let", lets.RequiredText(name), scope_);
    Add(name, SymbolKind::kLet, static_cast<int>(lets_.size()), &scope_);
    lets_.push_back(node);
  }
  for (const std::string& name : names) {
    support::StrictTable state = states.Table(name);
    FormState nodes;
    nodes.start = Lower("states", state.Text("start", "0"), scope_);
    if (state.Has("next"))
      nodes.next = Lower("states", state.RequiredText("next"), scope_);
    else
      nodes.rate = Lower("states", state.RequiredText("rate"), scope_);
    states_.push_back(nodes);
  }
  formula_ = Lower("formula", table_->RequiredText("formula"), scope_);
}

void FormFormula::Adopt(const armcmc::EffectForm& form) {
  support::StrictTable with = table_->Table("with");
  Scope theirs;
  Add("t", SymbolKind::kSignal, static_cast<int>(FormSignal::kTime), &theirs);
  const auto define = [&](const std::string& name, const std::string& by_default) {
    const int node = Lower("with", with.Has(name) ? with.RequiredText(name) : by_default, scope_);
    Add(name, SymbolKind::kLet, static_cast<int>(lets_.size()), &theirs);
    lets_.push_back(node);
  };
  for (const EffectNeed& need : form.needs)
    if (need.kind == "signal" || with.Has(need.name) || scope_.Find(need.name) != nullptr) define(need.name, need.name);
  for (const EffectConstant& constant : form.constants) {
    // Sizes of the catalogue are those of a plant file.
    if (!with.Has(constant.name) && constant.value != "start" && constant.value != "dt")
      throw table_->Error("with", "expected a value of \"" + constant.name + "\"");
    define(constant.name, constant.value == "start" ? "origin" : constant.value);
  }
  for (const EffectParameter& parameter : form.parameters) define(parameter.name, parameter.name);
  for (std::size_t k = 0; k < form.states.size(); ++k)
    Add(form.states[k].name, SymbolKind::kState, kFirstState + static_cast<int>(k), &theirs);
  for (const LetDescription& let : form.lets) {
    const int node = Lower("takes", let.text, theirs);
    Add(let.name, SymbolKind::kLet, static_cast<int>(lets_.size()), &theirs);
    lets_.push_back(node);
  }
  for (const StateDescription& state : form.states)
    states_.push_back({Lower("takes", state.start, theirs), Lower("takes", state.rate, theirs), -1});
  formula_ = Lower("takes", form.terms.front().formula, theirs);
}

template <class Kind>
std::shared_ptr<const Kind> FormFormula::Program(int node) {
  try {
    return std::make_shared<const Kind>(&graph_, states_, node);
  } catch (const std::invalid_argument& error) {
    throw table_->Error("slot", error.what());
  }
}

template std::shared_ptr<const FormProgram> FormFormula::Program(int node);
template std::shared_ptr<const ForceProgram> FormFormula::Program(int node);

std::vector<std::shared_ptr<const FormProgram>> FormFormula::Columns(int num_amplitudes) {
  std::vector<std::shared_ptr<const FormProgram>> columns;
  for (int a = 0; a < num_amplitudes; ++a) {
    const int column = graph_.Differentiate(formula_, graph_.Symbol(SymbolKind::kParameter, kFirstValue + a));
    for (int other = 0; other < num_amplitudes && column >= 0; ++other)
      if (graph_.DependsOn(column, graph_.Symbol(SymbolKind::kParameter, kFirstValue + other)))
        throw table_->Error("amplitudes", "the formula is not linear in them");
    if (column < 0) throw table_->Error("amplitudes", "the formula has no derivative by them");
    columns.push_back(Program<FormProgram>(column));
  }
  return columns;
}

void FormFormula::TakeFrom(const std::string& name) {
  formula_ = graph_.Make(Op::kSubtract, graph_.Symbol(SymbolKind::kSignal, scope_.Find(name)->index), formula_);
}

void FormFormula::TakeOff(const std::string& name) {
  formula_ = graph_.Make(Op::kSubtract, formula_, graph_.Symbol(SymbolKind::kSignal, scope_.Find(name)->index));
}

}  // namespace armcmc::gap
