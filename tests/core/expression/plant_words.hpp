#pragma once

#include "armcmc/expression/scope.hpp"

namespace armcmc::test {

/// Signals x, v and u, parameters K, B, p and tau, a state s, constants g (without a unit) and L (1 m), time.
inline expression::Scope PlantWords() {
  using expression::ParseUnit;
  using expression::Symbol;
  using expression::SymbolKind;
  expression::Scope scope;
  const auto add = [&](const char* name, SymbolKind kind, int index, std::optional<expression::Unit> unit,
                       expression::Interval range = {}) {
    Symbol symbol;
    symbol.name = name;
    symbol.kind = kind;
    symbol.index = index;
    symbol.unit = unit;
    symbol.range = range;
    scope.Add(symbol);
  };
  add("x", SymbolKind::kSignal, 0, ParseUnit("m"));
  add("v", SymbolKind::kSignal, 1, ParseUnit("m/s"));
  add("u", SymbolKind::kSignal, 2, ParseUnit("1"));
  add("t", SymbolKind::kTime, 0, ParseUnit("s"));
  add("K", SymbolKind::kParameter, 0, ParseUnit("N/m"), {0.0, 10.0});
  add("B", SymbolKind::kParameter, 1, ParseUnit("N s/m"), {0.0, 10.0});
  add("p", SymbolKind::kParameter, 2, ParseUnit("1"), {1.0, 2.5});
  add("tau", SymbolKind::kParameter, 3, ParseUnit("s"), {0.0, 1.0});
  add("s", SymbolKind::kState, 0, ParseUnit("m"));
  add("g", SymbolKind::kConstant, 0, std::nullopt, {9.81, 9.81});
  scope.symbols().back().value = 9.81;
  add("L", SymbolKind::kConstant, 1, ParseUnit("m"), {1.0, 1.0});
  scope.symbols().back().value = 1.0;
  return scope;
}

}  // namespace armcmc::test
