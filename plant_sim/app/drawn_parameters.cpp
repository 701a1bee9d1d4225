#include "drawn_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "armcmc/plant_sim/rng.hpp"

namespace armcmc::plant_sim {
namespace {

using support::ConfigError;
using support::StrictTable;

constexpr std::uint64_t kParameterStream = 0xd1;

/// A parameter of the file: what was drawn or given, and what it is still to be multiplied with.
struct Entry {
  double value = 0.0;
  double at_depth = 0.0;  ///< 0: none.
  int times = -1;         ///< Index of the other parameter; -1: none.
};

int IndexOf(const PlantFamily& family, const std::string& name) {
  const auto it = std::find_if(family.parameters.begin(), family.parameters.end(),
                               [&name](const ParameterSpec& spec) { return spec.name == name; });
  return static_cast<int>(it - family.parameters.begin());
}

bool IsTable(StrictTable* table, const std::string& key) {
  if (!table->Has(key)) return false;
  try {
    static_cast<void>(table->Table(key));
    return true;
  } catch (const ConfigError&) {
    return false;
  }
}

Entry ReadRange(StrictTable range, const ParameterSpec& spec, const PlantFamily& family, double u) {
  constexpr double kMax = 1e12;
  const bool scaled = range.Has("at_depth") || range.Has("times");
  const double low = range.RequiredNumber("low", scaled ? -kMax : spec.lo, scaled ? kMax : spec.hi);
  const double high = range.RequiredNumber("high", low, scaled ? kMax : spec.hi);
  const bool logarithmic = range.Choice("law", "uniform", {"uniform", "log_uniform"}) == "log_uniform";
  if (logarithmic && !(low > 0.0)) throw range.Error("low", "must be positive for law = \"log_uniform\"");
  Entry entry;
  entry.value = logarithmic ? low * std::pow(high / low, u) : low + u * (high - low);
  if (range.Has("at_depth")) {
    if (spec.power.empty()) throw range.Error("at_depth", "the unit of " + spec.name + " holds no power of the depth");
    entry.at_depth = range.RequiredNumber("at_depth", 1e-9, 1e3);
  }
  if (range.Has("times")) {
    std::vector<std::string> others;
    for (const ParameterSpec& other : family.parameters)
      if (other.name != spec.name) others.push_back(other.name);
    entry.times = IndexOf(family, range.RequiredChoice("times", others));
    if (entry.at_depth > 0.0) throw range.Error("at_depth", "contradicts times: a multiple needs no depth");
  }
  return entry;
}

}  // namespace

std::vector<double> ReadParameters(StrictTable table, const PlantFamily& family, std::uint64_t seed) {
  Rng rng(seed, kParameterStream);
  std::vector<Entry> entries;
  for (const ParameterSpec& spec : family.parameters) {
    // Every parameter takes its draw, so that a range on one does not change another's.
    const double u = rng.Uniform();
    Entry entry;
    if (IsTable(&table, spec.name))
      entry = ReadRange(table.Table(spec.name), spec, family, u);
    else
      entry.value = table.RequiredNumber(spec.name, spec.lo, spec.hi);
    entries.push_back(entry);
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].at_depth > 0.0) {
      const double power = entries[static_cast<std::size_t>(IndexOf(family, family.parameters[i].power))].value;
      entries[i].value *= std::pow(entries[i].at_depth, -power);
    }
  }
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const ParameterSpec& spec = family.parameters[i];
    double value = entries[i].value;
    if (entries[i].times >= 0) {
      const Entry& other = entries[static_cast<std::size_t>(entries[i].times)];
      if (other.times >= 0) throw table.Error(spec.name, "times names a parameter that is a multiple itself");
      value *= other.value;
    }
    if (!(value >= spec.lo && value <= spec.hi))
      throw table.Error(spec.name, "the range leads to " + std::to_string(value) + " " + spec.unit + ", outside [" +
                                       std::to_string(spec.lo) + ", " + std::to_string(spec.hi) + "]");
    values.push_back(value);
  }
  return values;
}

}  // namespace armcmc::plant_sim
