#include "armcmc/plant/plant.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "armcmc/expression/syntax.hpp"
#include "armcmc/plant/between.hpp"

namespace armcmc {
namespace {

using expression::Meaning;
using expression::Op;
using expression::Symbol;
using expression::SymbolKind;
using expression::Syntax;
using expression::Unit;

Unit Second() {
  Unit second;
  second.exponent[2] = 1.0;
  return second;
}

std::string Listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

bool IsPlantName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

/// FNV-1a, 64 bit.
void AddToHash(std::string_view text, std::uint64_t* hash) {
  for (const char c : text) *hash = (*hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  *hash = (*hash ^ 0xffU) * 0x100000001b3ULL;  // between texts
}

void CheckPrior(const std::string& key, const ParameterDescription& p) {
  if (p.prior != "normal" && p.prior != "uniform" && p.prior != "lognormal")
    throw PlantError(key + ".prior", 0, "expected normal, uniform or lognormal", p.prior,
                     {"normal", "uniform", "lognormal"});
  if (p.prior == "uniform") {
    if (!p.lower || !p.upper) throw PlantError(key, 0, "a uniform prior needs lower and upper");
  } else if (!(p.sd > 0.0) || !std::isfinite(p.sd)) {
    throw PlantError(key + ".sd", 0, "expected a number above 0");
  }
  if (p.prior == "lognormal" && !(p.mean > 0.0))
    throw PlantError(key + ".mean", 0, "the median of a lognormal prior is above 0");
  if (p.prior == "lognormal" && p.lower && !(*p.lower >= 0.0))
    throw PlantError(key + ".lower", 0, "a lognormal parameter is never negative");
}

/// Bounds of a parameter, filled in where the file has none.
expression::Interval Bounds(const ParameterDescription& p) {
  constexpr double kReach = 8.0;  // standard deviations
  if (p.prior == "lognormal")
    return {p.lower.value_or(p.mean * std::exp(-kReach * p.sd)), p.upper.value_or(p.mean * std::exp(kReach * p.sd))};
  return {p.lower.value_or(p.mean - kReach * p.sd), p.upper.value_or(p.mean + kReach * p.sd)};
}

}  // namespace

Plant::Plant(PlantDescription description) : description_(std::move(description)) {
  if (!IsPlantName(description_.name)) throw PlantError("name", 0, "expected lower-case letters, digits and _");
  if (description_.name.size() > kMaxNameLength)
    throw PlantError("name", 0, "a plant's name has at most " + std::to_string(kMaxNameLength) + " characters");
  AddSignals();
  AddConstants();
  AddParameters();
  AddStates();
  AddLets();
  AddModes();
  AddRates();
  AddReports();
  UseHeldForms();
  CheckParametersHaveInfluence();
  Identify();
}

void Plant::Identify() {
  identity_ = fingerprint_;
  const auto add = [&](const auto&... texts) { (AddToHash(texts, &identity_), ...); };
  const auto number = [&](double value) { AddToHash(std::to_string(std::bit_cast<std::uint64_t>(value)), &identity_); };
  add(description_.name, description_.law, description_.predicts);
  for (const auto& c : description_.constants) add(c.name), number(c.value);
  for (const auto& p : description_.parameters) add(p.name, p.unit, p.prior), number(p.per_mode ? 1.0 : 0.0);
  for (const auto& l : description_.lets) add(l.name, l.text);
  for (const auto& m : description_.modes) add(m.name, m.when, m.law, m.target), number(m.passive ? 1.0 : 0.0);
  for (const auto& s : description_.states) add(s.name, s.rate, s.start, s.measured_by), number(s.substeps);
  for (const auto& r : description_.reports) add(r.name, r.unit, r.value);
  for (const auto& s : description_.signals)
    if (BetweenNamed(s.between) != Between::kLinear) add(s.name, s.between);
}

void Plant::AddSymbol(const std::string& key, Symbol symbol) {
  if (symbol.name == "t") throw PlantError(key, 0, "t is the plant's time: choose another name");
  if (!expression::IsFreeName(symbol.name))
    throw PlantError(
        key, 0,
        '"' + symbol.name +
            "\" cannot be a name in an expression: expected letters, digits and _, and not the name of a function");
  if (scope_.Find(symbol.name) != nullptr)
    throw PlantError(key, 0, '"' + symbol.name + "\" is already the name of something else");
  // Signals, parameters and states are there whether a text uses them or not.
  if (symbol.kind == SymbolKind::kSignal || symbol.kind == SymbolKind::kParameter || symbol.kind == SymbolKind::kState)
    (void)graph_.Symbol(symbol.kind, symbol.index);
  scope_.Add(std::move(symbol));
}

std::optional<Unit> Plant::UnitAt(const std::string& key, const std::string& text) const {
  try {
    return expression::ParseUnit(text);
  } catch (const expression::Error& error) {
    throw PlantError(key, error.column(), error.what());
  }
}

int Plant::SignalAt(const std::string& key, const std::string& name) const {
  std::vector<std::string> names;
  for (std::size_t s = 0; s < description_.signals.size(); ++s) {
    if (description_.signals[s].name == name) return static_cast<int>(s);
    names.push_back(description_.signals[s].name);
  }
  throw PlantError(key, 0, "no signal is called \"" + name + "\"; there are " + Listed(names), name, names);
}

void Plant::AddSignals() {
  const auto& signals = description_.signals;
  if (signals.size() < 2) throw PlantError("signals", 0, "expected an output and at least one input");
  if (signals.size() > static_cast<std::size_t>(kMaxInputs) + 1)
    throw PlantError("signals", 0, "at most " + std::to_string(kMaxInputs) + " inputs and the output are possible");
  for (std::size_t s = 0; s < signals.size(); ++s) {
    Symbol symbol;
    symbol.name = signals[s].name;
    symbol.kind = SymbolKind::kSignal;
    symbol.index = static_cast<int>(s);
    symbol.unit = UnitAt("signals." + signals[s].name + ".unit", signals[s].unit);
    AddSymbol("signals." + signals[s].name, std::move(symbol));
  }
  output_ = SignalAt("output", description_.output);
  for (const SignalDescription& signal : signals) {
    if (signal.derivative_of.empty()) continue;
    const std::string key = "signals." + signal.name + ".derivative_of";
    const SignalDescription* of = &signals[static_cast<std::size_t>(SignalAt(key, signal.derivative_of))];
    for (std::size_t steps = 0; !of->derivative_of.empty() || of->name == signal.name; ++steps) {
      if (of->name == signal.name || steps > signals.size())
        throw PlantError(key, 0, signal.name + " would be a rate of itself");
      of = &signals[static_cast<std::size_t>(SignalAt("signals." + of->name + ".derivative_of", of->derivative_of))];
    }
    const auto unit = scope_.Find(signal.name)->unit;
    const auto unit_of = scope_.Find(signal.derivative_of)->unit;
    if (unit && unit_of && !unit->Same(unit_of->Over(Second())))
      throw PlantError(key, 0,
                       signal.name + " is " + unit->Text() + ", the rate of " + signal.derivative_of + " would be " +
                           unit_of->Over(Second()).Text());
  }
  Symbol time;
  time.name = "t";
  time.kind = SymbolKind::kTime;
  time.unit = Second();
  scope_.Add(std::move(time));

  fingerprint_ = 0xcbf29ce484222325ULL;
  for (const SignalDescription& signal : signals)
    for (const std::string* text : {&signal.name, &signal.unit, &signal.role}) AddToHash(*text, &fingerprint_);
  AddToHash(description_.output, &fingerprint_);
}

void Plant::AddConstants() {
  for (std::size_t c = 0; c < description_.constants.size(); ++c) {
    const ConstantDescription& constant = description_.constants[c];
    const std::string key = "constants." + constant.name;
    if (!std::isfinite(constant.value)) throw PlantError(key, 0, "expected a finite number");
    Symbol symbol;
    symbol.name = constant.name;
    symbol.kind = SymbolKind::kConstant;
    symbol.index = static_cast<int>(c);
    symbol.value = constant.value;
    symbol.range = {constant.value, constant.value};
    if (!constant.unit.empty()) symbol.unit = UnitAt(key + ".unit", constant.unit);
    AddSymbol(key, std::move(symbol));
  }
}

void Plant::AddParameters() {
  auto& parameters = description_.parameters;
  if (parameters.empty()) throw PlantError("parameters", 0, "a plant has at least one parameter");
  for (std::size_t d = 0; d < parameters.size(); ++d) {
    ParameterDescription& p = parameters[d];
    const std::string key = "parameters." + p.name;
    CheckPrior(key, p);
    const expression::Interval bounds = Bounds(p);
    if (!(bounds.lower < bounds.upper)) throw PlantError(key, 0, "lower is not below upper");
    constexpr double kReach = 5.0;
    if (p.prior == "normal" && (bounds.lower > p.mean + kReach * p.sd || bounds.upper < p.mean - kReach * p.sd))
      throw PlantError(key, 0, "the bounds hold none of the prior's mass: the mean is more than 5 sd outside");
    p.lower = bounds.lower;
    p.upper = bounds.upper;
    Symbol symbol;
    symbol.name = p.name;
    symbol.kind = SymbolKind::kParameter;
    symbol.index = static_cast<int>(d);
    symbol.unit = UnitAt(key + ".unit", p.unit);
    symbol.range = bounds;
    AddSymbol(key, std::move(symbol));
  }
}

void Plant::AddStates() {
  const auto& states = description_.states;
  if (states.size() > static_cast<std::size_t>(kMaxStates))
    throw PlantError("states", 0, "at most " + std::to_string(kMaxStates) + " states are possible");
  for (std::size_t s = 0; s < states.size(); ++s) {
    Symbol symbol;
    symbol.name = states[s].name;
    symbol.kind = SymbolKind::kState;
    symbol.index = static_cast<int>(s);
    symbol.unit = UnitAt("states." + states[s].name + ".unit", states[s].unit);
    AddSymbol("states." + states[s].name, std::move(symbol));
  }
}

Plant::Lowered Plant::Lower(const std::string& key, const std::string& text, const std::optional<Unit>& unit,
                            std::string_view what, const std::string& given) {
  try {
    const Syntax syntax = expression::Parse(text);
    for (const expression::SyntaxNode& node : syntax.nodes)
      if (node.op == Op::kSymbol) ++mentions_[node.name];
    const std::optional<Syntax> condition = given.empty() ? std::nullopt : std::optional(expression::Parse(given));
    const Meaning meaning = Check(syntax, scope_, condition ? &*condition : nullptr);
    Expect(meaning, unit, syntax, what);
    if (meaning.doubtful_power > 0)
      notes_.push_back({key, meaning.doubtful_power,
                        "the base of this power can be negative, and its exponent is not a whole number: candidates "
                        "for which that happens at any sample are rejected; max(.., 0)^.. keeps them"});
    return {graph_.Lower(syntax, scope_, lets_), meaning};
  } catch (const expression::UnknownName& error) {
    std::string message = error.what();
    for (const LetDescription& let : description_.lets)
      if (let.name == error.name())
        message = '"' + let.name + "\" is defined further down in [let]; move it above its first use";
    throw PlantError(key, error.column(), message, error.name(), scope_.Names());
  } catch (const expression::Error& error) {
    throw PlantError(key, error.column(), error.what());
  }
}

void Plant::AddLets() {
  for (const LetDescription& let : description_.lets) {
    const std::string key = "let." + let.name;
    const Lowered lowered = Lower(key, let.text);
    Symbol symbol;
    symbol.name = let.name;
    symbol.kind = SymbolKind::kLet;
    symbol.index = static_cast<int>(lets_.size());
    symbol.unit = lowered.meaning.unit;
    symbol.range = lowered.meaning.range;
    symbol.condition = lowered.meaning.condition;
    symbol.sampled = lowered.meaning.sampled;
    symbol.fixed = lowered.meaning.fixed;
    AddSymbol(key, std::move(symbol));
    lets_.push_back(lowered.node);
  }
}

int Plant::NodeOf(SymbolKind kind, int index) const {
  for (int n = 0; n < graph_.size(); ++n) {
    const expression::GraphNode& node = graph_.at(n);
    if (node.op == Op::kSymbol && node.kind == kind && node.index == index) return n;
  }
  return -1;
}

std::vector<int> Plant::SignalsWithRole(std::string_view role) const {
  std::vector<int> found;
  for (std::size_t s = 0; s < description_.signals.size(); ++s)
    if (description_.signals[s].role == role) found.push_back(static_cast<int>(s));
  return found;
}

}  // namespace armcmc
