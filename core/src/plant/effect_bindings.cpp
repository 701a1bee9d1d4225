#include <algorithm>
#include <optional>

#include "armcmc/expression/unit.hpp"
#include "armcmc/plant/effect.hpp"
#include "effect_reading.hpp"
#include "effect_targets.hpp"
#include "effect_text.hpp"
#include "effect_units.hpp"

namespace armcmc {
namespace {

using expression::Unit;

struct EffectCandidate {
  std::string name, role, unit;
};

std::vector<EffectCandidate> CandidatesOf(const PlantDescription& plant, const std::string& kind) {
  std::vector<EffectCandidate> all;
  if (kind == "state")
    for (const StateDescription& s : plant.states) all.push_back({s.name, s.role, s.unit});
  else if (kind == "parameter")
    for (const ParameterDescription& p : plant.parameters) all.push_back({p.name, "", p.unit});
  else if (kind == "constant")
    for (const ConstantDescription& c : plant.constants) {
      if (!IsTargetReference(c.name)) all.push_back({c.name, "", c.unit});
    }
  else
    for (const SignalDescription& s : plant.signals)
      if (s.name != plant.output) all.push_back({s.name, s.role, s.unit});
  return all;
}

const SignalDescription* OutputSignal(const PlantDescription& plant) {
  for (const SignalDescription& s : plant.signals)
    if (s.name == plant.output) return &s;
  return nullptr;
}

/// unit = output / x^n with some n > 0. If n is a parameter, texts are compared: "N/m^p".
bool IsPerPower(const std::string& unit, const std::string& output, const std::string& x) {
  const std::optional<Unit> whole = KnownUnit(unit), above = KnownUnit(output), below = KnownUnit(x);
  if (!above || !below) return false;
  if (!whole) {
    const std::string begin = output + '/' + x + '^';
    return unit.starts_with(begin);
  }
  for (const double n : {1.0, 1.5, 2.0, 3.0, 0.5})
    if (whole->Same(above->Over(below->Power(n)))) return true;
  return false;
}

bool IsRateOf(const PlantDescription& plant, const std::string& rate, const std::string& of) {
  return std::any_of(plant.signals.begin(), plant.signals.end(),
                     [&](const SignalDescription& s) { return s.name == rate && s.derivative_of == of; });
}

/// One form in one plant.
class FormBinder {
 public:
  FormBinder(const PlantDescription& plant, const EffectForm& form, std::size_t number)
      : plant_(plant), form_(form), number_(number) {}

  std::vector<EffectBinding> All() {
    const SignalDescription* output = OutputSignal(plant_);
    if (output == nullptr) return {};
    const auto& roles = form_.explains;
    if (!roles.empty() && std::find(roles.begin(), roles.end(), output->role) == roles.end()) {
      why_ = "its output would be a " + Or(roles);
      return {};
    }
    const bool on_output =
        NeedsOneLaw(form_) || std::any_of(form_.terms.begin(), form_.terms.end(),
                                          [](const auto& term) { return term.slot == "output" || term.slot == "law"; });
    if (on_output && !ExplainsOutput(plant_)) {
      why_ = "its modes explain something other than the output";
      return {};
    }
    if (NeedsOneLaw(form_) && plant_.predicts.empty() && !MayMerge(plant_)) {
      why_ = "its modes cannot be written as one law: a parameter differs from mode to mode";
      return {};
    }
    Bind(0);
    return std::move(found_);
  }

  [[nodiscard]] const std::string& why() const noexcept { return why_; }

 private:
  static std::string Or(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " or ") + word;
    return text;
  }

  void Bind(std::size_t n) {  // NOLINT(misc-no-recursion): as deep as there are needs
    if (n == form_.needs.size()) {
      if (TermsFit()) found_.push_back({number_, symbols_});
      return;
    }
    const EffectNeed& need = form_.needs[n];
    bool any = false;
    for (const EffectCandidate& candidate : CandidatesOf(plant_, need.kind)) {
      const bool taken = std::any_of(symbols_.begin(), symbols_.end(),
                                     [&](const auto& symbol) { return symbol.second == candidate.name; });
      if (taken || !Fits(need, candidate)) continue;
      any = true;
      symbols_[need.name] = candidate.name;
      Bind(n + 1);
      symbols_.erase(need.name);
    }
    if (!any && why_.empty())
      why_ = "it has no " + need.kind + (need.roles.empty() ? "" : " with the role " + Or(need.roles)) +
             (need.unit.empty() ? "" : " in " + need.unit) + (need.used ? " that the law reads" : "") +
             (need.reads.empty() ? "" : " whose rate reads " + need.reads) +
             (need.rate_of.empty() ? "" : " that is the derivative of " + need.rate_of);
  }

  [[nodiscard]] std::string UnitText(const std::string& symbol) const {
    for (const char* kind : {"signal", "state", "parameter", "constant"})
      for (const EffectCandidate& candidate : CandidatesOf(plant_, kind))
        if (candidate.name == symbol) return candidate.unit;
    return "";
  }

  /// Conditions on other needs are checked when all are bound.
  [[nodiscard]] bool Fits(const EffectNeed& need, const EffectCandidate& candidate) const {
    if (!need.roles.empty() && std::find(need.roles.begin(), need.roles.end(), candidate.role) == need.roles.end())
      return false;
    if (!need.unit.empty()) {
      const std::optional<Unit> wanted = KnownUnit(need.unit), found = KnownUnit(candidate.unit);
      if (!wanted || !found || !wanted->Same(*found)) return false;
    }
    if (need.used && !LawReads(plant_, candidate.name)) return false;
    return true;
  }

  /// One text of the plant, lets put in, says all of them: a constant has no role that tells what it is of.
  [[nodiscard]] bool OccurInOneExpression() const {
    std::vector<std::string> texts{plant_.law, plant_.predicts};
    for (const ModeDescription& mode : plant_.modes) texts.insert(texts.end(), {mode.law, mode.target});
    for (const StateDescription& state : plant_.states) texts.push_back(state.rate);
    return std::any_of(texts.begin(), texts.end(), [&](const std::string& text) {
      const std::string whole = WithoutLets(plant_, text);
      return std::all_of(form_.needs.begin(), form_.needs.end(),
                         [&](const EffectNeed& need) { return Mentions(whole, symbols_.at(need.name)); });
    });
  }

  bool TermsFit() {
    const bool of_constant = std::any_of(form_.needs.begin(), form_.needs.end(),
                                         [](const EffectNeed& need) { return need.kind == "constant"; });
    if (of_constant && !OccurInOneExpression()) {
      why_ = "no expression of it reads such a constant together with the others";
      return false;
    }
    for (const EffectNeed& need : form_.needs) {
      if (!need.reads.empty() && !RateReads(plant_, symbols_.at(need.name), symbols_.at(need.reads))) return false;
      if (!need.rate_of.empty() && !IsRateOf(plant_, symbols_.at(need.name), symbols_.at(need.rate_of))) {
        why_ = "it has no signal that is the derivative of " + need.rate_of;
        return false;
      }
      if (!need.per.empty() &&
          !IsPerPower(UnitText(symbols_.at(need.name)), OutputSignal(plant_)->unit, UnitText(symbols_.at(need.per))))
        return false;
    }
    return std::all_of(form_.terms.begin(), form_.terms.end(), [&](const auto& term) { return TermFits(term); });
  }

  bool TermFits(const EffectTerm& term) {
    if (term.slot == "output" || term.slot == "law") return true;
    const std::string& symbol = symbols_.at(term.of);
    if (!LawReads(plant_, symbol)) {
      why_ = "no law reads " + symbol;
      return false;
    }
    if (term.slot == "rate") return true;
    for (const ModeDescription& mode : plant_.modes) {
      // A mode that explains something else is chosen by what was measured.
      if (mode.target.empty() && !mode.passive && Mentions(mode.when, symbol) && !MayMerge(plant_)) {
        why_ = "a mode depends on " + symbol + ", and the modes cannot be written as one law";
        return false;
      }
    }
    return true;
  }

  const PlantDescription& plant_;
  const EffectForm& form_;
  std::size_t number_;
  std::map<std::string, std::string> symbols_;
  std::vector<EffectBinding> found_;
  std::string why_;
};

}  // namespace

std::vector<EffectBinding> Bindings(const PlantDescription& plant, const EffectEntry& entry) {
  const PlantDescription written = AsWritten(plant);
  std::vector<EffectBinding> all;
  bool usual = false;
  for (std::size_t f = 0; f < entry.forms.size(); ++f) {
    if (!entry.forms[f].variant && usual) continue;
    std::vector<EffectBinding> found = FormBinder(written, entry.forms[f], f).All();
    usual = usual || (!entry.forms[f].variant && !found.empty());
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

std::string WhyNot(const PlantDescription& plant, const EffectEntry& entry) {
  if (!Bindings(plant, entry).empty()) return "";
  const PlantDescription written = AsWritten(plant);
  std::string text;
  for (std::size_t f = 0; f < entry.forms.size(); ++f) {
    if (entry.forms[f].variant) continue;
    FormBinder binder(written, entry.forms[f], f);
    (void)binder.All();
    if (text.find(binder.why()) == std::string::npos) text += (text.empty() ? "" : "; ") + binder.why();
  }
  return text;
}

}  // namespace armcmc
