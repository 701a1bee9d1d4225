#include <algorithm>
#include <cmath>
#include <set>

#include "armcmc/expression/syntax.hpp"
#include "armcmc/expression/unit.hpp"
#include "armcmc/plant/effect.hpp"
#include "effect_reading.hpp"
#include "effect_text.hpp"
#include "effect_units.hpp"

namespace armcmc {
namespace {

using NameList = std::vector<std::string>;

bool IsAmong(const NameList& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string CommaSeparated(const NameList& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

void ExpectOneOf(const std::string& key, const std::string& value, const NameList& known) {
  if (!IsAmong(known, value)) throw PlantError(key, 0, "expected " + CommaSeparated(known), value, known);
}

/// Everything of one form.
class FormChecker {
 public:
  FormChecker(const EffectForm& form, std::string key) : form_(form), key_(std::move(key)) {}

  void Check() {
    AddNames();
    CheckNeeds();
    CheckTexts();
    CheckSizes();
    for (const EffectParameter& p : form_.parameters)
      if (!mentioned_.contains(p.name)) throw PlantError(key_ + "parameters." + p.name, 0, p.name + " is not used");
    if (std::none_of(form_.parameters.begin(), form_.parameters.end(), [](const auto& p) { return !p.none.empty(); }))
      throw PlantError(key_ + "parameters", 0, "no parameter has `none`, the value at which the effect is not there");
  }

 private:
  void Add(const std::string& key, const std::string& name) {
    static const NameList reserved = {"t",     "law",  "rate", "output", "dt",    "record", "start", "period",
                                      "noise", "mean", "low",  "high",   "range", "unit",   "form",  "name"};
    if (!expression::IsFreeName(name) || IsAmong(reserved, name))
      throw PlantError(key_ + key, 0, '"' + name + "\" cannot be a name in an effect");
    if (IsAmong(names_, name)) throw PlantError(key_ + key, 0, '"' + name + "\" is already the name of something else");
    names_.push_back(name);
  }

  void AddNames() {
    for (const EffectNeed& need : form_.needs) Add("needs." + need.name, need.name);
    for (const EffectConstant& c : form_.constants) Add("constants." + c.name, c.name);
    for (const EffectParameter& p : form_.parameters) Add("parameters." + p.name, p.name);
    for (const StateDescription& s : form_.states) Add("states." + s.name, s.name);
    for (const LetDescription& l : form_.lets) Add("let." + l.name, l.name);
  }

  [[nodiscard]] NameList NeedNames() const {
    NameList names;
    for (const EffectNeed& need : form_.needs) names.push_back(need.name);
    return names;
  }

  void CheckNeeds() const {
    for (const EffectNeed& need : form_.needs) {
      const std::string key = key_ + "needs." + need.name;
      ExpectOneOf(key + ".kind", need.kind, {"signal", "state", "parameter", "constant"});
      for (const auto& [other, what] :
           {std::pair{need.per, ".per"}, std::pair{need.reads, ".reads"}, std::pair{need.rate_of, ".rate_of"}})
        if (!other.empty()) ExpectOneOf(key + what, other, NeedNames());
      if (!need.reads.empty() && need.kind != "state") throw PlantError(key + ".reads", 0, "only a state has a rate");
      if (!need.rate_of.empty() && need.kind != "signal")
        throw PlantError(key + ".rate_of", 0, "only a signal is measured as the derivative of another");
      if (!need.unit.empty()) (void)expression::ParseUnit(need.unit);
    }
  }

  void CheckText(const std::string& key, const std::string& text, NameList extra) {
    try {
      const expression::Syntax syntax = expression::Parse(text);
      for (const expression::SyntaxNode& node : syntax.nodes) {
        if (node.op != expression::Op::kSymbol) continue;
        mentioned_.insert(node.name);
        if (IsAmong(names_, node.name) || node.name == "t" || IsAmong(extra, node.name)) continue;
        NameList known = names_;
        known.insert(known.end(), extra.begin(), extra.end());
        throw PlantError(key_ + key, node.column,
                         '"' + node.name + "\" is neither one of the effect's names nor one that every effect has",
                         node.name, known);
      }
    } catch (const expression::UnknownName& error) {
      throw PlantError(key_ + key, error.column(), error.what(), error.name());
    } catch (const expression::Error& error) {
      throw PlantError(key_ + key, error.column(), error.what());
    }
  }

  void CheckTexts() {
    if (form_.terms.empty()) throw PlantError(key_ + "formula", 0, "expected a formula");
    NameList rates;
    for (const EffectNeed& need : form_.needs)
      if (need.kind == "state") rates.push_back("rate_" + need.name);
    const auto with = [&](const NameList& more) {
      NameList all = rates;
      all.insert(all.end(), more.begin(), more.end());
      return all;
    };
    for (std::size_t i = 0; i < form_.terms.size(); ++i) CheckTerm(i, with);
    for (const LetDescription& let : form_.lets) CheckText("let." + let.name, let.text, with({"law"}));
    for (const StateDescription& s : form_.states) {
      CheckText("states." + s.name + ".rate", s.rate, with({"law"}));
      CheckText("states." + s.name + ".start", s.start, {"output", "law"});
    }
  }

  template <class With>
  void CheckTerm(std::size_t i, const With& with) {
    const EffectTerm& term = form_.terms[i];
    const std::string at = i == 0 ? "" : "also[" + std::to_string(i - 1) + "].";
    ExpectOneOf(key_ + at + "slot", term.slot, {"output", "law", "rate", "input", "parameter"});
    if (term.slot == "output" || term.slot == "law") {
      if (!term.of.empty()) throw PlantError(key_ + at + "of", 0, "there is one output: nothing to choose");
      CheckText(at + "formula", term.formula, with({"law"}));
      return;
    }
    const std::string kind = term.slot == "rate" ? "state" : term.slot == "input" ? "signal" : "parameter";
    const std::string or_kind = term.slot == "parameter" ? "constant" : term.slot == "input" ? "state" : kind;
    const auto need =
        std::find_if(form_.needs.begin(), form_.needs.end(), [&](const auto& n) { return n.name == term.of; });
    if (need == form_.needs.end() || (need->kind != kind && need->kind != or_kind))
      throw PlantError(key_ + at + "of", 0, "expected a name of [needs] that is a " + kind, term.of, NeedNames());
    CheckText(at + "formula", term.formula, with(term.slot == "rate" ? NameList{"rate"} : NameList{}));
  }

  void CheckSize(const std::string& key, const std::string& text) const {
    std::map<std::string, std::string> bound;
    for (const EffectNeed& need : form_.needs) bound[need.name] = "";
    try {
      (void)ScaleValue(text, {}, {}, bound);
    } catch (const expression::UnknownName& error) {
      NameList known = {"output", "noise", "dt", "record", "period", "start"};
      for (const EffectNeed& need : form_.needs) known.push_back(need.name);
      throw PlantError(key_ + key, error.column(),
                       '"' + error.name() + "\" is not a known size; there are " + CommaSeparated(known), error.name(),
                       known);
    } catch (const expression::Error& error) {
      throw PlantError(key_ + key, error.column(), error.what());
    }
  }

  void CheckUnit(const std::string& key, const std::string& unit) const {
    std::map<std::string, std::string> units{{"output", "m"}};
    for (const EffectNeed& need : form_.needs) units[need.name] = "m";
    try {
      (void)UnitIn(unit, units);
    } catch (const expression::Error& error) {
      throw PlantError(key_ + key, 0, error.what());
    }
  }

  void CheckSizes() const {
    for (const EffectConstant& c : form_.constants) {
      CheckUnit("constants." + c.name + ".unit", c.unit);
      CheckSize("constants." + c.name + ".value", c.value);
    }
    for (const StateDescription& s : form_.states) CheckUnit("states." + s.name + ".unit", s.unit);
    for (const EffectParameter& p : form_.parameters) {
      const std::string key = "parameters." + p.name + '.';
      CheckUnit(key + "unit", p.unit);
      ExpectOneOf(key_ + key + "prior", p.prior, {"normal", "uniform", "lognormal"});
      const bool uniform = p.prior == "uniform";
      if (uniform && (p.lower.empty() || p.upper.empty()))
        throw PlantError(key_ + "parameters." + p.name, 0, "a uniform prior needs lower and upper");
      if (!uniform && p.sd.empty()) throw PlantError(key_ + "parameters." + p.name, 0, "expected sd");
      for (const auto& [what, text] : {std::pair{"mean", p.mean}, std::pair{"sd", p.sd}, std::pair{"lower", p.lower},
                                       std::pair{"upper", p.upper}, std::pair{"none", p.none}})
        if (!text.empty()) CheckSize(key + what, text);
    }
  }

  const EffectForm& form_;
  std::string key_;
  NameList names_;
  std::set<std::string> mentioned_;
};

}  // namespace

void CheckEffect(const EffectEntry& entry) {
  const bool is_name = !entry.name.empty() && std::all_of(entry.name.begin(), entry.name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
  if (!is_name || !expression::IsFreeName(entry.name))
    throw PlantError("name", 0, "expected lower-case letters, digits and _, beginning with a letter");
  if (entry.title.empty()) throw PlantError("title", 0, "expected what the effect is, in words");
  if (entry.family.empty()) throw PlantError("family", 0, "expected the family of the effect");
  if (entry.forms.empty()) throw PlantError("formula", 0, "expected a formula");
  for (std::size_t f = 0; f < entry.forms.size(); ++f) FormChecker(entry.forms[f], KeyOfForm(entry, f)).Check();
}

}  // namespace armcmc
