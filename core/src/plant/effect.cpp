#include "armcmc/plant/effect.hpp"

#include <algorithm>

#include "armcmc/plant/plant.hpp"
#include "effect_reading.hpp"
#include "effect_sense.hpp"
#include "effect_targets.hpp"
#include "effect_text.hpp"
#include "effect_units.hpp"

namespace armcmc {
namespace {

using NameMap = std::map<std::string, std::string>;

const std::string kRateOf = "rate_of_";  // and the state: of the let that holds a rate which an effect wraps

bool IsTaken(const PlantDescription& plant, const std::string& prefix) {
  const auto begins = [&](const auto& list) {
    return std::any_of(list.begin(), list.end(), [&](const auto& item) { return item.name.starts_with(prefix); });
  };
  return begins(plant.signals) || begins(plant.constants) || begins(plant.parameters) || begins(plant.lets) ||
         begins(plant.states) || begins(plant.reports);
}

/// "coulomb_friction_", or "coulomb_friction_2_" if the plant has names with that prefix.
std::string PrefixOf(const PlantDescription& plant, const EffectEntry& entry) {
  std::string prefix = entry.name + '_';
  for (int n = 2; IsTaken(plant, prefix); ++n) prefix = entry.name + '_' + std::to_string(n) + '_';
  return prefix;
}

std::string UnitOfSymbol(const PlantDescription& plant, const std::string& name) {
  for (const auto& s : plant.signals)
    if (s.name == name) return s.unit;
  for (const auto& s : plant.states)
    if (s.name == name) return s.unit;
  for (const auto& p : plant.parameters)
    if (p.name == name) return p.unit;
  for (const auto& c : plant.constants)
    if (c.name == name && !c.unit.empty()) return c.unit;
  return "1";
}

/// Sorted so that each follows those that it uses, otherwise in the given order.
std::vector<LetDescription> InOrder(std::vector<LetDescription> lets) {
  std::vector<LetDescription> ordered;
  while (!lets.empty()) {
    const auto stands_alone = [&](const LetDescription& let) {
      return std::none_of(lets.begin(), lets.end(),
                          [&](const LetDescription& other) { return Mentions(let.text, other.name); });
    };
    auto next = std::find_if(lets.begin(), lets.end(), stands_alone);
    if (next == lets.end()) next = lets.begin();  // a cycle, which is reported when the plant is read
    ordered.push_back(std::move(*next));
    lets.erase(next);
  }
  return ordered;
}

class Composer {
 public:
  Composer(const PlantDescription& plant, const EffectEntry& entry, const EffectBinding& binding,
           const DataScales& scales)
      : plant_(AsWritten(plant)),
        given_(plant_),
        form_(entry.forms[binding.form]),
        binding_(binding),
        scales_(scales),
        prefix_(PrefixOf(plant_, entry)),
        subtracted_(entry.resists && SenseOfResistance(plant_) < 0) {}

  PlantDescription Composed() {
    MakeNames();
    AddParameters();
    for (const EffectTerm& term : form_.terms)
      if (term.slot == "input" || term.slot == "parameter") Replace(term);
    MakeLawVisible();
    MakeRatesVisible();
    AddLetsAndStates();
    for (const EffectTerm& term : form_.terms) {
      if (term.slot == "rate") ChangeRate(term);
      if (term.slot == "output" || term.slot == "law") ChangeOutput(term);
    }
    plant_.lets = InOrder(std::move(plant_.lets));
    SetTargetSizes(scales_, &plant_);
    return std::move(plant_);
  }

 private:
  [[nodiscard]] StateDescription& State(const std::string& name) {
    return *std::find_if(plant_.states.begin(), plant_.states.end(), [&](const auto& s) { return s.name == name; });
  }

  void MakeNames() {
    units_["output"] = UnitOfSymbol(plant_, plant_.output);
    for (const auto& [need, symbol] : binding_.symbols) {
      names_[need] = symbol;
      units_[need] = UnitOfSymbol(plant_, symbol);
    }
    for (const EffectNeed& need : form_.needs)
      if (need.kind == "state") names_["rate_" + need.name] = State(binding_.symbols.at(need.name)).rate;
    for (const auto& c : form_.constants) names_[c.name] = prefix_ + c.name;
    for (const auto& p : form_.parameters) names_[p.name] = prefix_ + p.name;
    for (const auto& l : form_.lets) names_[l.name] = prefix_ + l.name;
    for (const auto& s : form_.states) names_[s.name] = prefix_ + s.name;
    names_["output"] = plant_.output;
  }

  [[nodiscard]] double Size(const std::string& text) const {
    try {
      return ScaleValue(text, given_, scales_, binding_.symbols);
    } catch (const expression::Error& error) {
      throw PlantError("effects", error.column(), "the size \"" + text + "\" of this effect: " + error.what());
    }
  }

  void AddParameters() {
    for (const EffectConstant& c : form_.constants)
      plant_.constants.push_back({prefix_ + c.name, Size(c.value), UnitIn(c.unit, units_)});
    for (const EffectParameter& p : form_.parameters) {
      ParameterDescription added;
      added.name = prefix_ + p.name;
      added.unit = UnitIn(p.unit, units_);
      added.prior = p.prior;
      if (p.prior != "uniform") {
        added.mean = ShortNumber(Size(p.mean));
        added.sd = ShortNumber(Size(p.sd));
      }
      if (!p.lower.empty()) added.lower = ShortNumber(Size(p.lower));
      if (!p.upper.empty()) added.upper = ShortNumber(Size(p.upper));
      plant_.parameters.push_back(std::move(added));
    }
  }

  /// Texts that determine the behaviour of the plant: laws, rates, lets, and conditions that may vary.
  /// @param symbol  Of a state, what others read is changed, and its own rate stays.
  template <class Change>
  void ForEachText(const std::string& symbol, const Change& change) {
    for (std::string* text : {&plant_.law, &plant_.predicts}) change(text);
    for (ModeDescription& mode : plant_.modes) change(&mode.law);
    for (LetDescription& let : plant_.lets)
      if (!IsTargetAsRead(let.name)) change(&let.text);
    for (StateDescription& state : plant_.states)
      if (state.name != symbol) change(&state.rate);
  }

  /// Name of what the effect makes of a signal or parameter: "contact_offset_x", or "contact_offset_of_d" where the
  /// effect has a d of its own.
  [[nodiscard]] std::string NameOfChanged(const std::string& symbol) const {
    const auto has = [&symbol](const auto& list) {
      return std::any_of(list.begin(), list.end(), [&symbol](const auto& own) { return own.name == symbol; });
    };
    const bool taken = has(form_.constants) || has(form_.parameters) || has(form_.lets) || has(form_.states);
    return prefix_ + (taken ? "of_" : "") + symbol;
  }

  void Replace(const EffectTerm& term) {
    const std::string& symbol = binding_.symbols.at(term.of);
    const bool decides = std::any_of(plant_.modes.begin(), plant_.modes.end(),
                                     [&](const auto& mode) { return Mentions(mode.when, symbol); });
    if (decides && MayMerge(plant_)) Merge();
    const std::string name = NameOfChanged(symbol);
    SplitTargets(prefix_, symbol, &plant_);
    ForEachText(symbol, [&](std::string* text) { *text = WithNames(*text, {{symbol, name}}); });
    plant_.lets.insert(plant_.lets.begin(), {name, Inserted(term.formula, names_)});
  }

  void Merge() {
    plant_.law = MergedLaw(plant_);
    plant_.modes.clear();
  }

  /// The explanation of the output gets a name if other texts use it, or one text more than once.
  void MakeLawVisible() {
    std::size_t mentions = 0;
    for (const EffectTerm& term : form_.terms)
      if (term.slot == "output" || term.slot == "law")
        for (const std::string& name : NamesIn(term.formula)) mentions += name == "law" ? 1U : 0U;
    const bool one_law = NeedsOneLaw(form_);
    if (one_law && plant_.predicts.empty() && !plant_.modes.empty()) Merge();
    std::string* law = !plant_.predicts.empty() ? &plant_.predicts : plant_.modes.empty() ? &plant_.law : nullptr;
    const bool spoken_of =
        std::any_of(form_.states.begin(), form_.states.end(), [](const auto& s) { return Mentions(s.rate, "law"); }) ||
        std::any_of(form_.lets.begin(), form_.lets.end(), [](const auto& l) { return Mentions(l.text, "law"); });
    if (law == nullptr || (!spoken_of && mentions < 2) || Bracketed(*law) == *law) {
      if (law != nullptr && spoken_of) names_["law"] = *law;
      return;
    }
    plant_.lets.push_back({prefix_ + "law", *law});
    *law = prefix_ + "law";
    names_["law"] = *law;
  }

  /// A rate that the effect wraps gets a name: what other effects add to it later, it wraps as well. A rim limits
  /// the total inflow, whichever of the two is named first.
  void MakeRatesVisible() {
    for (const EffectTerm& term : form_.terms) {
      if (term.slot != "rate" || !Mentions(term.formula, "rate")) continue;
      StateDescription& state = State(binding_.symbols.at(term.of));
      const std::string name = prefix_ + kRateOf + state.name;
      plant_.lets.push_back({name, state.rate});
      state.rate = name;
      names_["rate_" + term.of] = name;
    }
  }

  /// Position of the rate of a state that an earlier effect has wrapped; the end if none has.
  [[nodiscard]] auto WrappedRate(const std::string& state) {
    return std::find_if(plant_.lets.begin(), plant_.lets.end(),
                        [&](const LetDescription& let) { return let.name.ends_with('_' + (kRateOf + state)); });
  }

  void AddLetsAndStates() {
    const bool in_front = std::any_of(form_.terms.begin(), form_.terms.end(), [](const auto& term) {
      return term.slot == "input" || term.slot == "parameter";
    });
    std::vector<LetDescription> lets;
    for (const LetDescription& let : form_.lets) lets.push_back({prefix_ + let.name, Inserted(let.text, names_)});
    plant_.lets.insert(in_front ? plant_.lets.begin() : plant_.lets.end(), lets.begin(), lets.end());
    for (const StateDescription& state : form_.states) {
      StateDescription added = state;
      added.name = prefix_ + state.name;
      added.unit = UnitIn(state.unit, units_);
      added.rate = Inserted(state.rate, names_);
      added.start = Inserted(state.start, names_);
      plant_.states.push_back(std::move(added));
    }
  }

  void ChangeRate(const EffectTerm& term) {
    std::string& rate = State(binding_.symbols.at(term.of)).rate;
    NameMap names = names_;
    names["rate"] = rate;
    const std::string text = Inserted(term.formula, names);
    const auto wrapped = WrappedRate(binding_.symbols.at(term.of));
    const bool wraps = Mentions(term.formula, "rate");
    if (wraps)
      rate = text;
    else if (wrapped != plant_.lets.end() && !wrapped->name.starts_with(prefix_))
      wrapped->text = SumText(wrapped->text, text);
    else
      rate = SumText(rate, text);
  }

  void ChangeOutput(const EffectTerm& term) {
    const auto changed = [&](const std::string& law) {
      NameMap names = names_;
      names["law"] = law;
      std::string text = Inserted(term.formula, names);
      if (term.slot == "law") return text;
      // What is made of the law has the sign of the law already.
      const bool subtracted = subtracted_ && !Mentions(term.formula, "law");
      return SumText(law, subtracted ? NegativeText(text) : text);
    };
    if (!plant_.predicts.empty()) {
      plant_.predicts = changed(plant_.predicts);
    } else if (plant_.modes.empty()) {
      plant_.law = changed(plant_.law);
    } else {
      for (ModeDescription& mode : plant_.modes) {
        const bool shows_nothing =
            mode.passive && Mentions(term.formula, "law") && (mode.law.empty() || mode.law == "0");
        if (shows_nothing) continue;
        mode.law = changed(mode.law.empty() ? "0" : mode.law);
        mode.passive = false;
      }
    }
  }

  PlantDescription plant_;
  const PlantDescription given_;
  const EffectForm& form_;
  const EffectBinding& binding_;
  const DataScales& scales_;
  const std::string prefix_;
  const bool subtracted_;  ///< From the output: see EffectEntry::resists.
  NameMap names_, units_;
};

void CheckBinding(const PlantDescription& plant, const EffectEntry& entry, const EffectBinding& binding) {
  const std::vector<EffectBinding> all = Bindings(plant, entry);
  const bool fits = std::any_of(all.begin(), all.end(), [&](const EffectBinding& b) {
    return b.form == binding.form && b.symbols == binding.symbols;
  });
  if (fits) return;
  const std::string why = WhyNot(plant, entry);
  throw PlantError("effects", 0,
                   entry.name + " does not fit " + plant.name + (why.empty() ? " in this way" : ": " + why));
}

std::string ComposedText(const PlantDescription& plant, const std::string& key) {
  if (key == "law") return plant.law;
  if (key == "predicts") return plant.predicts;
  for (const LetDescription& let : plant.lets)
    if (key == "let." + let.name) return let.text;
  for (const StateDescription& state : plant.states)
    if (key == "states." + state.name + ".rate") return state.rate;
  for (std::size_t m = 0; m < plant.modes.size(); ++m)
    if (key == "mode[" + std::to_string(m) + "].law") return plant.modes[m].law;
  return "";
}

}  // namespace

PlantDescription AddEffect(const PlantDescription& plant, const EffectEntry& entry, const EffectBinding& binding,
                           const DataScales& scales) {
  CheckBinding(plant, entry, binding);
  PlantDescription composed = Composer(plant, entry, binding, scales).Composed();
  try {
    (void)Plant(composed);
  } catch (const PlantError& error) {
    const std::string text = ComposedText(composed, error.key());
    throw PlantError(
        "effects", 0,
        entry.name + " in " + plant.name + " gives " + error.key() + (text.empty() ? "" : " = \"" + text + '"') +
            (error.column() > 0 ? ", character " + std::to_string(error.column()) : "") + ": " + error.what());
  }
  return composed;
}

std::string AddedName(const PlantDescription& plant, const EffectEntry& entry, std::string_view name) {
  return PrefixOf(AsWritten(plant), entry) + std::string(name);
}

int NumFormulaParameters(const EffectForm& form) {
  const auto in_formula = [&](const EffectParameter& parameter) {
    const auto says = [&](const std::string& text) { return Mentions(text, parameter.name); };
    return std::any_of(form.terms.begin(), form.terms.end(), [&](const EffectTerm& t) { return says(t.formula); }) ||
           std::any_of(form.lets.begin(), form.lets.end(), [&](const LetDescription& l) { return says(l.text); }) ||
           std::any_of(form.states.begin(), form.states.end(), [&](const StateDescription& s) { return says(s.rate); });
  };
  return static_cast<int>(std::count_if(form.parameters.begin(), form.parameters.end(), in_formula));
}

std::map<std::string, double> NoEffect(const PlantDescription& plant, const EffectEntry& entry,
                                       const EffectBinding& binding, const DataScales& scales) {
  std::map<std::string, double> none;
  for (const EffectParameter& p : entry.forms.at(binding.form).parameters)
    if (!p.none.empty()) none[p.name] = ScaleValue(p.none, plant, scales, binding.symbols);
  return none;
}

}  // namespace armcmc
