#include "armcmc/plant/effect_scales.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "armcmc/expression/check.hpp"
#include "armcmc/expression/graph.hpp"
#include "armcmc/plant/error.hpp"
#include "armcmc/plant/plant.hpp"
#include "effect_units.hpp"

namespace armcmc {
namespace {

using expression::Unit;

constexpr double kTurn = 2.0 * std::numbers::pi;

Unit OneSecond() {
  Unit second;
  second.exponent[2] = 1.0;
  return second;
}

QuantityScale Resized(const QuantityScale& scale, double factor) {
  return {0.0, scale.rms * factor, -2.0 * scale.rms * factor, 2.0 * scale.rms * factor};
}

QuantityScale MeasuredScale(const std::string& name, const std::vector<double>& column) {
  if (std::any_of(column.begin(), column.end(), [](double value) { return !std::isfinite(value); }))
    throw PlantError("signals." + name, 0, "its data contain a value that is not a finite number");
  QuantityScale scale{0.0, 0.0, column.front(), column.front()};
  for (const double value : column) {
    scale.mean += value / static_cast<double>(column.size());
    scale.low = std::fmin(scale.low, value);
    scale.high = std::fmax(scale.high, value);
  }
  for (const double value : column)
    scale.rms += (value - scale.mean) * (value - scale.mean) / static_cast<double>(column.size());
  scale.rms = std::sqrt(scale.rms);
  // A constant signal has the size of its value.
  if (!(scale.rms > 1e-9 * std::fabs(scale.mean))) scale.rms = scale.mean != 0.0 ? std::fabs(scale.mean) : 1.0;
  return scale;
}

/// s; twice the mean time between crossings of the mean. One counts when half an rms is passed, so that noise does not.
double PeriodOf(const std::vector<double>& column, const QuantityScale& scale, double record) {
  int crossings = 0;
  int side = 0;
  for (const double value : column) {
    const int now = value > scale.mean + 0.5 * scale.rms ? 1 : value < scale.mean - 0.5 * scale.rms ? -1 : side;
    if (side != 0 && now != side) ++crossings;
    side = now;
  }
  return crossings > 1 ? 2.0 * record / crossings : record;
}

std::size_t OutputIndex(const PlantDescription& plant) {
  for (std::size_t s = 0; s < plant.signals.size(); ++s)
    if (plant.signals[s].name == plant.output) return s;
  throw PlantError("output", 0, "no signal is called \"" + plant.output + '"');
}

/// Signals without data are derived from the signal of which they are the rate, or from their own rate.
void FillRates(const PlantDescription& plant, DataScales* scales) {
  for (std::size_t round = 0; round < plant.signals.size(); ++round)
    for (const SignalDescription& signal : plant.signals) {
      if (signal.derivative_of.empty()) continue;
      const bool rate_known = scales->quantity.contains(signal.name);
      const bool of_known = scales->quantity.contains(signal.derivative_of);
      if (of_known && !rate_known)
        scales->quantity[signal.name] = Resized(scales->quantity[signal.derivative_of], kTurn / scales->period);
      if (rate_known && !of_known)
        scales->quantity[signal.derivative_of] = Resized(scales->quantity[signal.name], scales->period / kTurn);
    }
}

QuantityScale ScaleOfState(const PlantDescription& plant, const StateDescription& state, const DataScales& scales) {
  const std::optional<Unit> unit = KnownUnit(state.unit);
  if (!unit) return {};
  const SignalDescription* alike = nullptr;
  const SignalDescription* rate = nullptr;
  for (const SignalDescription& signal : plant.signals) {
    const std::optional<Unit> its = KnownUnit(signal.unit);
    if (!its) continue;
    const bool role = !state.role.empty() && signal.role == state.role;
    if (unit->Same(*its) && (alike == nullptr || role)) alike = &signal;
    if (unit->Same(its->Over(OneSecond())) && (rate == nullptr || signal.name == plant.output)) rate = &signal;
  }
  if (alike != nullptr) return scales.quantity.at(alike->name);
  if (rate != nullptr) return Resized(scales.quantity.at(rate->name), kTurn / scales.period);
  return {};
}

void FillTheRest(const PlantDescription& plant, DataScales* scales) {
  FillRates(plant, scales);
  for (const SignalDescription& signal : plant.signals) scales->quantity.try_emplace(signal.name);
  for (const StateDescription& state : plant.states)
    scales->quantity.try_emplace(state.name, ScaleOfState(plant, state, *scales));
}

double SizeOf(const ParameterDescription& p) {
  if (p.prior == "lognormal") return p.mean;
  if (p.prior == "uniform") return std::fmax(std::fabs(p.lower.value_or(0.0)), std::fabs(p.upper.value_or(1.0)));
  return std::fabs(p.mean) + p.sd;
}

/// Value of a parameter where it is sampled, at its prior's centre.
double CentreOf(const ParameterDescription& p) {
  if (p.prior == "lognormal") return std::log(p.mean);
  if (p.prior == "uniform") return 0.5 * (p.lower.value_or(0.0) + p.upper.value_or(1.0));
  return p.mean;
}

/// Of each state the largest |d rate / d x| times the rms of x, for signals and states x; about the means.
std::vector<double> LargestTerms(const Plant& plant, const DataScales& scales) {
  using expression::SymbolKind;
  const PlantDescription& description = plant.description();
  expression::Graph graph = plant.graph();
  std::map<int, int> by;
  std::vector<std::pair<int, double>> moves;  // node, rms
  const auto add = [&](SymbolKind kind, const auto& list, bool moving, const auto& centre) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      const int node = plant.NodeOf(kind, static_cast<int>(i));
      if (node < 0) continue;
      by.emplace(node, graph.Number(centre(list[i])));
      if (moving) moves.emplace_back(node, scales.quantity.at(list[i].name).rms);
    }
  };
  const auto mean = [&](const auto& of) { return scales.quantity.at(of.name).mean; };
  add(SymbolKind::kSignal, description.signals, true, mean);
  add(SymbolKind::kState, description.states, true, mean);
  add(SymbolKind::kParameter, description.parameters, false, CentreOf);
  std::vector<double> largest;
  for (const PlantState& state : plant.states()) {
    largest.push_back(0.0);
    for (const auto& [node, rms] : moves) {
      if (!graph.DependsOn(state.rate, node)) continue;
      const int slope = graph.Differentiate(state.rate, node);
      const int value = slope < 0 ? -1 : graph.Substitute(slope, by);
      if (value < 0 || !graph.IsNumber(value) || !std::isfinite(graph.at(value).value)) continue;
      largest.back() = std::fmax(largest.back(), std::fabs(graph.at(value).value) * rms);
    }
  }
  return largest;
}

/// Rates of states whose terms cancel.
void RaiseRates(const PlantDescription& plant, DataScales* scales) {
  constexpr double kOfLargest = 0.1;
  if (plant.states.empty()) return;
  try {
    const std::vector<double> largest = LargestTerms(Plant(plant), *scales);
    for (std::size_t s = 0; s < largest.size(); ++s) {
      QuantityScale& scale = scales->quantity.at(plant.states[s].name);
      if (kOfLargest * largest[s] > scale.rms * kTurn / scales->period) scale.rate = kOfLargest * largest[s];
    }
  } catch (const PlantError&) {  // a part of a plant: sizes are taken all the same
  }
}

}  // namespace

DataScales MeasuredScales(const PlantDescription& plant, const std::vector<std::vector<double>>& columns,
                          const std::vector<double>& times) {
  if (times.size() < 2) throw PlantError("signals", 0, "sizes are taken from at least two rows of data");
  const std::size_t output = OutputIndex(plant);
  DataScales scales;
  scales.start = times.front();
  scales.record = times.back() - times.front();
  scales.dt = scales.record / static_cast<double>(times.size() - 1);
  scales.noise = plant.noise.std;
  if (columns.size() != plant.signals.size() || columns[output].empty())
    throw PlantError("signals", 0, "expected a column for each signal, and data for the output");
  for (std::size_t s = 0; s < columns.size(); ++s) {
    if (columns[s].empty()) continue;
    if (columns[s].size() != times.size())
      throw PlantError("signals." + plant.signals[s].name, 0, "has another number of rows than the times");
    scales.quantity[plant.signals[s].name] = MeasuredScale(plant.signals[s].name, columns[s]);
  }
  scales.period = PeriodOf(columns[output], scales.quantity[plant.output], scales.record);
  FillTheRest(plant, &scales);
  RaiseRates(plant, &scales);
  return scales;
}

DataScales DefaultScales(const PlantDescription& plant) {
  constexpr double kSignalToNoise = 30.0;
  DataScales scales;
  scales.noise = plant.noise.std;
  scales.quantity[plant.output] = Resized({}, kSignalToNoise * plant.noise.std);
  const std::optional<Unit> output = KnownUnit(plant.signals.at(OutputIndex(plant)).unit);
  for (const SignalDescription& signal : plant.signals) {
    const std::optional<Unit> unit = KnownUnit(signal.unit);
    if (!output || !unit || scales.quantity.contains(signal.name)) continue;
    for (const ParameterDescription& p : plant.parameters) {
      const std::optional<Unit> gain = KnownUnit(p.unit);
      if (!gain || !gain->Same(output->Over(*unit)) || !(SizeOf(p) > 0.0)) continue;
      scales.quantity[signal.name] = Resized({}, scales.quantity[plant.output].rms / SizeOf(p));
      break;
    }
  }
  FillTheRest(plant, &scales);
  return scales;
}

double ScaleValue(std::string_view text, const PlantDescription& plant, const DataScales& scales,
                  const std::map<std::string, std::string>& bound) {
  expression::Scope scope;
  const auto add = [&](const std::string& name, double value) {
    expression::Symbol symbol;
    symbol.name = name;
    symbol.kind = expression::SymbolKind::kConstant;
    symbol.index = static_cast<int>(scope.symbols().size());
    symbol.value = value;
    symbol.range = {value, value};
    scope.Add(std::move(symbol));
  };
  add("dt", scales.dt);
  add("record", scales.record);
  add("start", scales.start);
  add("period", scales.period);
  add("noise", scales.noise);
  const auto add_quantity = [&](const std::string& name, const QuantityScale& scale) {
    add(name, scale.rms);
    add("mean_" + name, scale.mean);
    add("low_" + name, scale.low);
    add("high_" + name, scale.high);
    add("range_" + name, scale.high > scale.low ? scale.high - scale.low : scale.rms);
    add("rate_" + name, scale.rate > 0.0 ? scale.rate : scale.rms * kTurn / scales.period);
  };
  const auto scale_of = [&](const std::string& name) {
    for (const ParameterDescription& p : plant.parameters)
      if (p.name == name) return QuantityScale{p.mean, SizeOf(p), p.lower.value_or(0.0), p.upper.value_or(0.0)};
    for (const ConstantDescription& c : plant.constants)
      if (c.name == name) return QuantityScale{c.value, std::fabs(c.value), c.value, c.value};
    const auto found = scales.quantity.find(name);
    return found == scales.quantity.end() ? QuantityScale{} : found->second;
  };
  add_quantity("output", scale_of(plant.output));
  for (const auto& [name, of] : bound) add_quantity(name, scale_of(of));
  const expression::Syntax syntax = expression::Parse(text);
  const expression::Meaning meaning = Check(syntax, scope);
  expression::Graph graph;
  const int node = graph.Lower(syntax, scope, {});
  if (!meaning.fixed || !graph.IsNumber(node)) throw expression::Error(1, "expected a size that is taken from data");
  const double value = graph.at(node).value;
  if (!std::isfinite(value)) throw expression::Error(1, "this size is not a finite number");
  return value;
}

}  // namespace armcmc
