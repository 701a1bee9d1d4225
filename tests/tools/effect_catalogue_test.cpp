// The catalogue of effects, in every plant that comes along.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <numbers>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "armcmc/plant/effect.hpp"
#include "armcmc/plant/plant.hpp"
#include "armcmc/support/effect_file.hpp"
#include "armcmc/support/plant_file.hpp"
#include "armcmc/support/plant_writer.hpp"
#include "support/paths.hpp"
#include "support/plant_run.hpp"

namespace armcmc::support::effect_catalogue_test {
namespace {

std::vector<EffectEntry> Catalogue() {
  std::vector<EffectEntry> entries;
  for (const auto& file : std::filesystem::directory_iterator(test::SourceDir() / "core/effects"))
    entries.push_back(ReadEffect(file.path()));
  return entries;
}

PlantDescription Described(const std::string& name) {
  return ReadPlant(test::SourceDir() / "core/plants" / name / "plant.toml").description();
}

const std::vector<std::string>& PlantNames() {
  static const std::vector<std::string> names = {"friction_element", "hunt_crossley", "indentation",   "oscillator",
                                                 "pendulum",         "servo_axis",    "soft_actuator", "two_tanks"};
  return names;
}

std::map<std::string, double> Means(const PlantDescription& plant) {
  std::map<std::string, double> values;
  for (const ParameterDescription& p : plant.parameters)
    values[p.name] = p.prior == "uniform" ? 0.5 * (*p.lower + *p.upper) : p.mean;
  // At the means of their priors the valves' gains are 0, and the pressure would have no rate.
  if (plant.name == "soft_actuator") values["g"] = 1e-3, values["theta2"] = 1e-9;
  return values;
}

/// A recording for a plant: inputs that excite it, and the output that it predicts for the means of its priors.
struct Recording {
  double dt = 0.01;
  std::vector<double> times;
  std::vector<std::vector<double>> columns;
};

/// Sample interval, size and mean of the inputs that suit a plant.
struct Ranges {
  double dt;
  std::map<std::string, std::pair<double, double>> input;  ///< Name -> mean, size.
};

Ranges RangesOf(const std::string& plant) {
  if (plant == "oscillator") return {1.0 / 610.0, {{"u", {0.0, 0.1}}}};
  if (plant == "pendulum") return {0.02, {{"u", {0.0, 1.0}}}};
  if (plant == "two_tanks") return {1.0, {{"u", {4.0, 3.5}}}};
  if (plant == "soft_actuator") return {1e-3, {{"p", {2e5, 5e4}}, {"u_c", {0.2, 0.4}}, {"u_d", {0.1, 0.4}}}};
  if (plant == "indentation") return {1e-3, {{"x", {0.002, 0.01}}}};
  if (plant == "friction_element") return {0.01, {{"x", {0.0, 0.05}}, {"p", {3e5, 1e5}}}};
  return {0.01, {{"x", {0.1, 0.5}}, {"q", {0.0, 0.1}}}};
}

Recording RecordingOf(const std::string& name) {
  constexpr std::size_t kRows = 400;
  const Plant plant(Described(name));
  const Ranges ranges = RangesOf(name);
  const auto& signals = plant.description().signals;
  Recording recording;
  recording.dt = ranges.dt;
  recording.columns.assign(signals.size(), std::vector<double>(kRows, 0.0));
  const double w = 2.0 * std::numbers::pi / (90.0 * ranges.dt);
  for (std::size_t s = 0; s < signals.size(); ++s) {
    // Of which signal it is the rate, how many times over.
    std::string base = signals[s].name;
    int order = 0;
    for (bool found = true; found;) {
      found = false;
      for (const SignalDescription& at : signals)
        if (at.name == base && !at.derivative_of.empty()) base = at.derivative_of, ++order, found = true;
    }
    const auto range = ranges.input.find(base);
    if (range == ranges.input.end()) continue;
    for (std::size_t n = 0; n < kRows; ++n) {
      const double t = static_cast<double>(n) * ranges.dt;
      const auto wave = [&](double size, double frequency, double phase) {
        return size * std::pow(frequency, order) * std::sin(frequency * t + phase + order * 0.5 * std::numbers::pi);
      };
      recording.columns[s][n] = (order == 0 ? range->second.first : 0.0) + wave(range->second.second, w, 0.3) +
                                wave(0.4 * range->second.second, 2.7 * w, 1.1);
      // In the end one valve closes, and the other one opens.
      const double opens = (static_cast<double>(n) - 0.9 * kRows) / (0.05 * kRows);
      if (signals[s].name == "u_c") recording.columns[s][n] *= std::clamp(-opens, 0.0, 1.0);
      if (signals[s].name == "u_d") recording.columns[s][n] *= std::clamp(opens, 0.0, 1.0);
    }
  }
  auto& output = recording.columns[static_cast<std::size_t>(plant.output())];
  output[0] = name == "two_tanks" ? 5.0 : 0.0;
  output = test::PlantRun(plant, Means(plant.description())).Output(recording.columns, ranges.dt);
  for (std::size_t n = 0; n < kRows; ++n) recording.times.push_back(static_cast<double>(n) * ranges.dt);
  return recording;
}

double LargestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    const double difference = std::fabs(a[n] - b[n]);
    if (!(difference <= largest)) largest = difference;
  }
  return largest;
}

double RmsDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += (a[n] - b[n]) * (a[n] - b[n]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST(EffectCatalogue, WhatSlowsAStateResistsWhereTheLawIsAForce) {
  int resisting = 0;
  for (const EffectEntry& entry : Catalogue()) {
    bool slows = false, adds = false;
    for (const EffectForm& form : entry.forms) {
      // A size of either sign fits either law.
      if (form.parameters.empty() || form.parameters[0].lower != "0") continue;
      const std::vector<std::string> velocity = {"velocity"};
      for (const EffectTerm& term : form.terms) {
        adds = adds || (term.slot == "output" && form.needs[0].roles == velocity);
        slows = slows || (term.slot == "rate" && term.formula.starts_with('-') && form.needs[0].roles == velocity);
      }
    }
    EXPECT_TRUE(entry.resists || !slows || !adds) << entry.name;
    if (entry.resists) ++resisting;
  }
  EXPECT_GE(resisting, 12);
}

TEST(EffectCatalogue, IsAddedInThePlantsThatComeAlong) {
  for (const char* name : {"friction_element", "servo_axis"}) {
    const PlantDescription plant = Described(name);
    for (const EffectEntry& entry : Catalogue()) {
      if (entry.name != "coulomb_friction" && entry.name != "drag") continue;
      const std::string law = AddEffect(plant, entry, Bindings(plant, entry).at(0), DefaultScales(plant)).law;
      EXPECT_NE(law.find(" + " + entry.name), std::string::npos) << law;
    }
  }
}

TEST(EffectCatalogue, HasTheEffectsOfTheFieldWithWordsForPeople) {
  std::set<std::string> names;
  for (const EffectEntry& entry : Catalogue()) {
    names.insert(entry.name);
    EXPECT_FALSE(entry.experiment.empty()) << entry.name;
    EXPECT_GT(entry.title.size(), 20u) << entry.name;
  }
  EXPECT_GE(names.size(), 36u);
  for (const char* name : {"coulomb_friction", "overflow", "cubic_stiffness", "adhesion", "backlash",
                           "pressure_dependent_friction", "asymmetric_friction"})
    EXPECT_TRUE(names.contains(name)) << name;
  for (const EffectEntry& entry : Catalogue())
    for (const std::string& kin : entry.kin) EXPECT_TRUE(names.contains(kin)) << entry.name << " is no kin of " << kin;
}

class InPlant : public ::testing::TestWithParam<std::string> {};

/// What is left of an effect at `none`, over the size of the output: latencies that are states cannot be 0, and the
/// integration of a plant becomes finer with a state that needs it.
double LeftAtNothing(const PlantDescription& plant, const EffectForm& form) {
  for (const StateDescription& state : form.states)
    for (const EffectParameter& p : form.parameters)
      if (state.rate.find("/" + p.name) != std::string::npos && !p.none.empty()) return 0.5;
  const bool finer = std::any_of(form.states.begin(), form.states.end(), [](const auto& s) { return s.substeps > 1; });
  return finer && !plant.states.empty() ? 1e-4 : 1e-9;
}

/// The parameters of an effect half a standard deviation of their priors to one side of their means, or the other.
std::map<std::string, double> Moved(const PlantDescription& plant, std::map<std::string, double> values,
                                    const std::set<std::string>& names, double side) {
  for (const ParameterDescription& p : plant.parameters)
    if (names.contains(p.name) && p.prior == "normal")
      values[p.name] = std::clamp(p.mean + side * 0.5 * p.sd, *p.lower, *p.upper);
  return values;
}

TEST_P(InPlant, EveryEffectThatFitsVanishesAtNothingAndShowsOtherwise) {
  const PlantDescription plant = Described(GetParam());
  const Recording recording = RecordingOf(GetParam());
  const DataScales scales = MeasuredScales(plant, recording.columns, recording.times);
  const Plant plain(plant);
  const auto base = test::PlantRun(plain, Means(plant)).Output(recording.columns, recording.dt);
  const double size = scales.quantity.at(plant.output).rms;
  // Of a plant that predicts its output an effect may show in what its modes explain.
  const auto base_law = test::PlantRun(plain, Means(plant)).Explained(recording.columns, recording.dt);
  const double law_size =
      plant.predicts.empty() ? size : RmsDifference(base_law, std::vector<double>(base_law.size(), 0.0));
  int fitting = 0;
  for (const EffectEntry& entry : Catalogue())
    for (const EffectBinding& binding : Bindings(plant, entry)) {
      const EffectForm& form = entry.forms[binding.form];
      SCOPED_TRACE(entry.name + " " + form.name);
      ++fitting;
      const Plant composed(AddEffect(plant, entry, binding, scales));
      const auto output = [&](const std::map<std::string, double>& values) {
        return test::PlantRun(composed, values).Output(recording.columns, recording.dt);
      };
      const auto law = [&](const std::map<std::string, double>& values) {
        return test::PlantRun(composed, values).Explained(recording.columns, recording.dt);
      };
      std::map<std::string, double> none = Means(composed.description());
      std::set<std::string> names;
      for (const auto& [name, value] : NoEffect(plant, entry, binding, scales)) {
        names.insert(AddedName(plant, entry, name));
        none[AddedName(plant, entry, name)] = value;
      }
      const double left = LeftAtNothing(plant, form);
      const double difference = left > 0.1 ? RmsDifference(output(none), base) : LargestDifference(output(none), base);
      EXPECT_LE(difference, left * size);
      const double law_difference =
          left > 0.1 ? RmsDifference(law(none), base_law) : LargestDifference(law(none), base_law);
      EXPECT_LE(law_difference, left * law_size);
      double change = 0.0;
      for (const double side : {-1.0, 1.0}) {
        const auto values = Moved(composed.description(), Means(composed.description()), names, side);
        // A spring that softens too much has no solution.
        const double moved = LargestDifference(output(values), base);
        if (std::isfinite(moved)) change = std::max(change, moved);
        const double law_moved = LargestDifference(law(values), base_law) * size / law_size;
        if (std::isfinite(law_moved)) change = std::max(change, law_moved);
      }
      EXPECT_GT(change, 1e-3 * size);
      EXPECT_LT(change, 100.0 * size) << "out of all proportion";
      EXPECT_EQ(composed.fingerprint(), plain.fingerprint()) << "packs of the plant fit it still";
    }
  EXPECT_GE(fitting, 10);
}

TEST_P(InPlant, EveryCompositionIsTheSamePlantWhenItsFileIsRead) {
  const PlantDescription plant = Described(GetParam());
  const DataScales scales = DefaultScales(plant);
  EXPECT_EQ(PlantFromText(PlantFileText(plant), "base").identity(), Plant(plant).identity());
  for (const EffectEntry& entry : Catalogue())
    for (const EffectBinding& binding : Bindings(plant, entry)) {
      const Plant composed(AddEffect(plant, entry, binding, scales));
      const Plant read = PlantFromText(PlantFileText(composed.description(), "a comment\nof two lines"), "composed");
      EXPECT_EQ(read.identity(), composed.identity()) << entry.name;
      ASSERT_EQ(read.description().parameters.size(), composed.description().parameters.size());
      for (std::size_t p = 0; p < composed.description().parameters.size(); ++p) {
        const ParameterDescription& a = read.description().parameters[p];
        const ParameterDescription& b = composed.description().parameters[p];
        EXPECT_EQ(a.mean, b.mean) << entry.name;
        EXPECT_EQ(a.sd, b.sd);
        EXPECT_EQ(*a.lower, *b.lower);
        EXPECT_EQ(*a.upper, *b.upper);
      }
    }
}

std::string Renamed(const std::string& text, const std::string& from, const std::string& to) {
  return std::regex_replace(text, std::regex("\\b" + from + "\\b"), to);
}

/// The plant with another name for one of its signals, parameters, constants or states.
PlantDescription Renamed(PlantDescription plant, const std::string& from, const std::string& to) {
  const auto rename = [&](std::initializer_list<std::string*> texts) {
    for (std::string* text : texts) *text = Renamed(*text, from, to);
  };
  rename({&plant.output, &plant.law, &plant.predicts});
  for (SignalDescription& s : plant.signals) rename({&s.name, &s.derivative_of});
  for (ConstantDescription& c : plant.constants) rename({&c.name});
  for (ParameterDescription& p : plant.parameters) rename({&p.name});
  for (LetDescription& l : plant.lets) rename({&l.text});
  for (ModeDescription& m : plant.modes) rename({&m.when, &m.law, &m.target});
  for (StateDescription& s : plant.states) rename({&s.name, &s.rate, &s.start, &s.measured_by});
  for (ReportDescription& r : plant.reports) rename({&r.value});
  return plant;
}

std::vector<std::string> OwnNames(const EffectForm& form) {
  std::vector<std::string> names;
  for (const auto& c : form.constants) names.push_back(c.name);
  for (const auto& p : form.parameters) names.push_back(p.name);
  for (const auto& l : form.lets) names.push_back(l.name);
  for (const auto& s : form.states) names.push_back(s.name);
  return names;
}

TEST_P(InPlant, EveryEffectFitsSymbolsThatAreCalledLikeItsOwn) {
  const PlantDescription plant = Described(GetParam());
  const auto names_of = [](const auto& list, std::set<std::string>* names) {
    for (const auto& item : list) names->insert(item.name);
  };
  std::set<std::string> taken;
  names_of(plant.signals, &taken), names_of(plant.parameters, &taken), names_of(plant.constants, &taken);
  names_of(plant.states, &taken), names_of(plant.lets, &taken), names_of(plant.reports, &taken);
  int tried = 0;
  for (const EffectEntry& entry : Catalogue())
    for (const EffectBinding& binding : Bindings(plant, entry))
      for (const std::string& own : OwnNames(entry.forms[binding.form]))
        for (const auto& [need, symbol] : binding.symbols) {
          if (taken.contains(own)) continue;
          SCOPED_TRACE(::testing::Message() << entry.name << ": " << symbol << " called " << own);
          const PlantDescription renamed = Renamed(plant, symbol, own);
          EffectBinding same = binding;
          for (auto& [other, bound] : same.symbols) bound = Renamed(bound, symbol, own);
          EXPECT_NO_THROW(Plant{AddEffect(renamed, entry, same, DefaultScales(renamed))});
          ++tried;
        }
  EXPECT_GE(tried, 10);
}

INSTANTIATE_TEST_SUITE_P(Plants, InPlant, ::testing::ValuesIn(PlantNames()), [](const auto& at) { return at.param; });

}  // namespace
}  // namespace armcmc::support::effect_catalogue_test
