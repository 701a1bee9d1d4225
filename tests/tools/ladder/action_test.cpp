#include "action.hpp"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "armcmc/support/effect_library.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::ladder::action_test {
namespace {

/// Ways in which catalogue effects fit the swing: its law is a state, so that what acts on the motion acts on a rate.
class Action : public ::testing::Test {
 protected:
  Action() {
    const PlantDescription plant = test::SwingPlant();
    const DataScales scales = ScalesOf(test::SwingData([](double u) { return u; }), plant, 0.003);
    std::vector<std::string> notes;
    all_ = Candidates(plant, entries_, scales, &notes);
  }

  /// The first way of an effect; that of a form where one is named.
  const Candidate& Of(const std::string& effect, const std::string& form = "") const {
    for (const Candidate& c : all_)
      if (c.entry->name == effect && (form.empty() || c.form().name == form)) return c;
    throw std::invalid_argument("the swing has no " + effect);
  }

 private:
  const std::vector<EffectEntry> entries_ = support::ReadEffectLibrary();
  std::vector<Candidate> all_;
};

TEST_F(Action, FunctionsOfOneQuantityInOneEquationAreCurvesOfOneThing) {
  EXPECT_TRUE(ActOnSameQuantity(Of("cubic_stiffness"), Of("quadratic_stiffness")));
  EXPECT_TRUE(ActOnSameQuantity(Of("quadratic_stiffness"), Of("cubic_stiffness")));
  EXPECT_TRUE(ActOnSameQuantity(Of("input_dead_band"), Of("input_saturation")));  // of the drive
}

TEST_F(Action, OfAnotherQuantityOrEquationTheyAreNot) {
  EXPECT_FALSE(ActOnSameQuantity(Of("cubic_stiffness"), Of("drag")));                       // place and speed
  EXPECT_FALSE(ActOnSameQuantity(Of("output_drift"), Of("periodic_disturbance", "load")));  // shown and felt
  EXPECT_FALSE(ActOnSameQuantity(Of("cubic_stiffness"), Of("output_bias")));                // of nothing at all
}

TEST_F(Action, WhatHasAPastIsNoCurve) {
  for (const char* remembers : {"hysteresis", "input_hysteresis", "sensor_lag", "sensor_delay"}) {
    EXPECT_TRUE(Remembers(Of(remembers))) << remembers;
    EXPECT_FALSE(ActOnSameQuantity(Of("cubic_stiffness"), Of(remembers))) << remembers;
  }
  for (const char* forgets : {"cubic_stiffness", "drag", "output_drift", "input_saturation", "sensor_saturation"})
    EXPECT_FALSE(Remembers(Of(forgets))) << forgets;
}

TEST_F(Action, AnEffectReadsWhatItsFormulaSays) {
  EXPECT_TRUE(Reads(Of("cubic_stiffness"), "pos"));
  EXPECT_FALSE(Reads(Of("cubic_stiffness"), "speed"));
  EXPECT_FALSE(Reads(Of("cubic_stiffness"), "t"));
  EXPECT_TRUE(Reads(Of("input_saturation"), "u"));
  EXPECT_TRUE(Reads(Of("output_drift"), "t"));
  EXPECT_FALSE(Reads(Of("output_drift"), "u"));
  EXPECT_TRUE(ActsOnLaw(Of("sensor_saturation")));
  EXPECT_FALSE(ActsOnLaw(Of("output_drift")));
}

TEST_F(Action, FrequenciesAreAlongWhatTheirUnitSays) {
  const std::vector<Frequency> hum = Of("periodic_disturbance").Frequencies();
  ASSERT_EQ(hum.size(), 1u);
  EXPECT_EQ(hum[0].along, "");
  const Candidate& cogging = Of("cogging");
  const std::vector<Frequency> ripple = cogging.Frequencies();
  ASSERT_EQ(ripple.size(), 1u);
  EXPECT_EQ(ripple[0].along, "pos");
  EXPECT_EQ(cogging.plant->description().parameters[ripple[0].parameter].name, "cogging_k");
  EXPECT_TRUE(Of("cubic_stiffness").Frequencies().empty());
}

TEST(InputOfAState, IsChangedForOtherStatesAndNotForItself) {
  PlantDescription plant;
  plant.name = "circuit";
  plant.output = "y";
  plant.law = "b";
  plant.signals = {{"u", "V", "drive", ""}, {"y", "V", "voltage", ""}};
  plant.parameters = {{"Ta", "s", "lognormal", 0.01, 0.7}, {"Tb", "s", "lognormal", 0.02, 0.7}};
  plant.states = {{"a", "V", "voltage", "(u - a)/Ta", "0", "", 1}, {"b", "V", "voltage", "(a - b)/Tb", "0", "", 1}};
  const DataScales scales = ScalesOf(test::SwingData([](double u) { return u; }), plant, 0.003);
  const std::vector<EffectEntry> entries = support::ReadEffectLibrary();
  std::vector<std::string> notes;
  int found = 0;
  for (const Candidate& c : Candidates(plant, entries, scales, &notes)) {
    if (c.form().name != "between") continue;
    ++found;
    EXPECT_EQ(c.plant->description().states[0].rate, "(u - a)/Ta");
    EXPECT_EQ(c.plant->description().states[1].rate, "(input_saturation_a - b)/Tb");
  }
  EXPECT_EQ(found, 1);
}

TEST(ActionOfAxis, ProportionsAndRelaxationsAreToldFromCurvesAndFrictions) {
  const PlantDescription plant = test::AxisPlant();
  const std::vector<EffectEntry> entries = support::ReadEffectLibrary();
  const DataScales scales = ScalesOf(test::AxisData([](const auto&) { return 0.0; }), plant, 2.0);
  std::vector<std::string> notes;
  std::set<std::string> straight, relaxing;
  for (const Candidate& c : Candidates(plant, entries, scales, &notes)) {
    if (IsProportionalTo(c, "v")) straight.insert(c.entry->name);
    if (Relaxes(c)) relaxing.insert(c.entry->name);
  }
  EXPECT_EQ(straight, std::set<std::string>{"viscous_friction"});
  EXPECT_EQ(relaxing, std::set<std::string>{"stress_relaxation"}) << "and no friction, no play, no oscillation";
}

}  // namespace
}  // namespace armcmc::ladder::action_test
