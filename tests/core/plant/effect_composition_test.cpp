// What an effect makes of the equations of a plant.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "armcmc/plant/effect.hpp"
#include "armcmc/plant/plant.hpp"
#include "core/plant/effect_entries.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::effect_composition_test {
namespace {

using test::Added;
using test::Amplitude;
using test::Filled;
using test::Friction;
using test::Need;
using test::OnInput;
using test::WithTerm;

TEST(EffectComposition, AddsATermWithItsParameterInTheUnitOfTheOutput) {
  const PlantDescription composed = Added(test::DescribedAxis(), Friction());
  EXPECT_EQ(composed.law, "M*a + Fv*v + off + friction_Fc*sign(v)");
  const ParameterDescription& added = composed.parameters.back();
  EXPECT_EQ(added.name, "friction_Fc");
  EXPECT_EQ(added.unit, "N");
  EXPECT_EQ(added.sd, 15.0) << "half of 30 standard deviations of the noise, which is 1 N";
  EXPECT_EQ(*added.lower, 0.0);
  EXPECT_EQ(Plant(composed).fingerprint(), Plant(test::DescribedAxis()).fingerprint());
}

/// What friction that resists motion adds to a law of v, a, a force P, a parameter k >= 0, and numbers c > 0 and n < 0.
std::string Resistance(const std::string& law, const std::string& formula = "Fc*sign(v)") {
  EffectEntry entry = Friction();
  entry.resists = true;
  entry.forms[0].terms[0].formula = formula;
  PlantDescription plant = test::DescribedAxis();
  plant.law = law;
  plant.signals.push_back({"P", "N", "", ""});
  plant.parameters = {{"k", "N", "normal", 0.0, 1.0, 0.0, 8.0}};
  plant.constants = {{"c", 3.0, ""}, {"n", -2.0, ""}};
  const std::string composed = Added(plant, entry).law;
  EXPECT_TRUE(composed.starts_with(law)) << composed;
  return composed.substr(law.size());
}

TEST(EffectComposition, SubtractsWhatResistsMotionFromAForceThatThePlantPassesOn) {
  for (const char* law : {"c*k*a + k", "P + c*k*v", "k - c*(-k*v)", "c*k*a - c*k*v", "k*tanh(c*v)", "k + k*c*v/c",
                          "k*(c*v)^3", "k*c*v - n*k*c*v"})
    EXPECT_EQ(Resistance(law), " + friction_Fc*sign(v)") << law;
  for (const char* law : {"P - c*k*a - k", "k - c*k*(c*v + P)", "P - lowpass(c*k*a, 0.1)", "n*k*v", "k - exp(-c)*c*k*v",
                          "if(P > 0, k - c*a, -k - c*a)", "k + min(P, -c*k*v)", "k*v/n", "k - (c*v)^3"})
    EXPECT_EQ(Resistance(law), " - friction_Fc*sign(v)") << law;
  // Laws that fall and rise, or that read no motion, do not tell.
  for (const char* law : {"k - c*k*v^2", "P*v*c*k", "k + P", "n*k*v*abs(v)", "k*c*v + n*k*v", "-k*abs(c*v)"})
    EXPECT_EQ(Resistance(law), " + friction_Fc*sign(v)") << law;
}

TEST(EffectComposition, SubtractsInTheUsualNotation) {
  EXPECT_EQ(Resistance("P - c*k*v", "Fc + Fc*sign(v)"), " - (friction_Fc + friction_Fc*sign(v))");
  EXPECT_EQ(Resistance("P - c*k*v", "-Fc*sign(v)"), " + friction_Fc*sign(v)");
  EXPECT_EQ(Resistance("P - c*k*v", "if(v > 0, Fc, -Fc)"), " - if(v > 0, friction_Fc, -friction_Fc)");
}

TEST(EffectComposition, AddsWhatIsMadeOfALawThatFalls) {
  EXPECT_EQ(Resistance("P - c*k*v", "Fc*(law/k - 1)"), " + friction_Fc*((P - c*k*v)/k - 1)");
}

TEST(EffectComposition, KeepsTheSignOfAnEffectThatDoesNotSayThatItResists) {
  PlantDescription plant = test::DescribedAxis();
  plant.law = "off - M*a - Fv*v";
  EXPECT_EQ(Added(plant, Friction()).law, "off - M*a - Fv*v + friction_Fc*sign(v)");
}

TEST(EffectComposition, TakesNoNameFromANumber) {
  EffectEntry entry = Friction();
  entry.forms[0].terms[0].formula = "e*1e-3*sign(v) + 2.5e1*e";
  entry.forms[0].parameters[0].name = "e";
  EXPECT_EQ(Added(test::DescribedAxis(), entry).law, "M*a + Fv*v + off + friction_e*1e-3*sign(v) + 2.5e1*friction_e");
}

TEST(EffectComposition, GivesNamesThatAreTakenANumber) {
  PlantDescription plant = test::DescribedAxis();
  plant.law += " + friction_Fc";
  plant.parameters.push_back({"friction_Fc", "N", "normal", 0.0, 1.0});
  const PlantDescription composed = Added(Added(plant, Friction()), Friction());
  EXPECT_EQ(composed.law, "M*a + Fv*v + off + friction_Fc + friction_2_Fc*sign(v) + friction_3_Fc*sign(v)");
  EXPECT_EQ(AddedName(plant, Friction(), "Fc"), "friction_2_Fc");
}

TEST(EffectComposition, ReadsWhatAPlantSaysOfItselfLikeWhatAFileSays) {
  const Plant understood(test::DescribedAxis());
  EXPECT_EQ(Plant(understood.description()).identity(), understood.identity());
  EXPECT_EQ(Added(understood.description(), Friction()).law, Added(test::DescribedAxis(), Friction()).law);
}

TEST(EffectComposition, ActsInEveryModeWhichIsThenNoLongerPassive) {
  const PlantDescription composed = Added(test::DescribedContact(), Friction());
  ASSERT_EQ(composed.modes.size(), 2u);
  EXPECT_EQ(composed.modes[0].law, "x^p * (K + B*v) + friction_Fc*sign(v)");
  EXPECT_EQ(composed.modes[1].law, "friction_Fc*sign(v)");
  EXPECT_FALSE(composed.modes[1].passive);
}

TEST(EffectComposition, MakesOneLawOfModesWhereMemoryGoesThroughThem) {
  EffectEntry lag = WithTerm("law", "lowpass(law, c)", "s");
  const PlantDescription composed = Added(test::DescribedContact(), lag);
  EXPECT_TRUE(composed.modes.empty());
  EXPECT_EQ(composed.law, "lowpass(if(x >= 0, x^p * (K + B*v), 0), changed_c)");
}

TEST(EffectComposition, MovesTheConditionOfAModeWithTheInputThatItReads) {
  EffectEntry offset = WithTerm("input", "x - c", "x");
  offset.forms[0].needs = {Need("x", "signal", "position")};
  offset.forms[0].needs[0].used = true;
  offset.forms[0].terms[0].of = "x";
  const PlantDescription composed = Added(test::DescribedContact(), offset);
  ASSERT_EQ(composed.lets.size(), 1u);
  EXPECT_EQ(composed.lets[0].name, "changed_x");
  EXPECT_EQ(composed.lets[0].text, "x - changed_c");
  EXPECT_EQ(composed.law, "if(changed_x >= 0, changed_x^p * (K + B*v), 0)");
}

TEST(EffectComposition, ChangesASignalThatIsCalledLikeItsOwnParameter) {
  PlantDescription plant = test::DescribedAxis();
  plant.signals[0].name = "c";
  plant.signals[1].derivative_of = "c";
  plant.law = "M*a + Fv*c + off";
  EffectEntry offset = OnInput("v", "signal", "v - c");
  offset.forms[0].needs[0].roles = {"velocity"};
  const PlantDescription composed = Added(plant, offset);
  EXPECT_EQ(composed.lets.front().name, "changed_of_c");
  EXPECT_EQ(composed.lets.front().text, "c - changed_c");
  EXPECT_EQ(composed.law, "M*a + Fv*changed_of_c + off");
  EXPECT_NO_THROW(Plant{composed});
}

TEST(EffectComposition, TakesThePlaceOfTheLawWhichIsInParentheses) {
  EXPECT_EQ(Added(test::DescribedAxis(), WithTerm("law", "law*(1 + c)")).law, "(M*a + Fv*v + off)*(1 + changed_c)");
  const PlantDescription twice = Added(test::DescribedAxis(), WithTerm("law", "abs(law - c) + 0*law", "output"));
  EXPECT_EQ(twice.law, "abs(changed_law - changed_c) + 0*changed_law");
  EXPECT_EQ(twice.lets.back().text, "M*a + Fv*v + off");
}

TEST(EffectComposition, AddsToTheRateOfTheStateThatHasTheRole) {
  EffectEntry entry = WithTerm("rate", "-c*v", "1/s");
  entry.forms[0].explains.clear();
  entry.forms[0].needs = {Need("v", "state", "velocity")};
  entry.forms[0].terms[0].of = "v";
  const PlantDescription composed = Added(test::SimulatedSpring(), entry);
  EXPECT_EQ(composed.states[1].rate, "u - k*pos - changed_c*speed");
}

TEST(EffectComposition, WrapsWhatIsAddedToARateLaterAsIfItHadBeenThereBefore) {
  EffectEntry limit = WithTerm("rate", "rate - surplus", "v/s");
  limit.name = "limit";
  limit.forms[0].explains.clear();
  limit.forms[0].needs = {Need("v", "state", "velocity")};
  limit.forms[0].terms[0].of = "v";
  limit.forms[0].lets = {{"surplus", "max(rate_v - c, 0)"}};
  EffectEntry drag = WithTerm("rate", "-pull", "1/s");
  drag.name = "drag";
  drag.forms[0].explains.clear();
  drag.forms[0].needs = limit.forms[0].needs;
  drag.forms[0].terms[0].of = "v";
  drag.forms[0].lets = {{"pull", "c*v"}};
  const PlantDescription later = Added(Added(test::SimulatedSpring(), limit), drag);
  EXPECT_EQ(later.states[1].rate, "limit_rate_of_speed - limit_surplus");
  ASSERT_EQ(later.lets.size(), 3U);
  EXPECT_EQ(later.lets[0].text, "drag_c*speed");
  EXPECT_EQ(later.lets[1].text, "u - k*pos - drag_pull");
  EXPECT_EQ(later.lets[2].text, "max(limit_rate_of_speed - limit_c, 0)");
  const PlantDescription before = Added(Added(test::SimulatedSpring(), drag), limit);
  EXPECT_EQ(before.states[1].rate, later.states[1].rate);
  EXPECT_EQ(before.lets[1].text, later.lets[1].text);
  // One limit in another: both hold back what is added.
  const PlantDescription twice = Added(Added(Added(test::SimulatedSpring(), limit), limit), drag);
  EXPECT_EQ(twice.states[1].rate, "limit_2_rate_of_speed - limit_2_surplus");
  EXPECT_NO_THROW(Plant{twice});
}

TEST(EffectComposition, AddsStatesAndLetsUnderNamesOfItsOwn) {
  EffectEntry entry = Friction();
  EffectForm& form = entry.forms[0];
  form.terms[0].formula = "Fc*pull";
  form.lets = {{"pull", "tanh(z)"}};
  form.states = {{"z", "v s", "", "v - z/tau", "0", ""}};
  form.parameters.push_back(Amplitude("tau", "s", "1"));
  form.parameters[1].prior = "lognormal";
  form.parameters[1].mean = "10*dt";
  form.terms[0].formula = "Fc*pull";
  form.lets[0].text = "tanh(z/reach)";
  form.constants = {{"reach", "v s", "0.1*v*period"}};
  const PlantDescription composed = Added(test::DescribedAxis(), entry);
  EXPECT_EQ(composed.law, "M*a + Fv*v + off + friction_Fc*friction_pull");
  EXPECT_EQ(composed.lets.back().text, "tanh(friction_z/friction_reach)");
  EXPECT_EQ(composed.states.back().rate, "v - friction_z/friction_tau");
  EXPECT_EQ(composed.states.back().unit, "(m/s) s");
  EXPECT_EQ(composed.parameters.back().mean, 0.1);
}

TEST(EffectComposition, ChangesAParameterWhereverItIsRead) {
  EffectEntry entry = WithTerm("parameter", "k*(1 + c*t)", "1/s");
  entry.forms[0].explains.clear();
  entry.forms[0].needs = {Need("k", "parameter", "")};
  entry.forms[0].needs[0].unit = "1/s^2";
  entry.forms[0].terms[0].of = "k";
  const PlantDescription composed = Added(test::SimulatedSpring(), entry);
  EXPECT_EQ(composed.lets.front().text, "k*(1 + changed_c*t)");
  EXPECT_EQ(composed.states[1].rate, "u - changed_k*pos");
}

TEST(EffectComposition, LeavesATargetAsItIsReadAndMovesTheLaw) {
  EffectEntry bias = OnInput("p", "signal", "p - c");
  bias.forms[0].needs[0].roles = {"pressure"};
  const PlantDescription composed = Added(Filled(), bias);
  EXPECT_EQ(composed.modes[0].target, "u*(source - p)");
  EXPECT_EQ(composed.modes[0].law,
            "changed_target_as_read_1 - (changed_target_as_felt_1 - (k*r))*changed_target_size_1");
  const auto let = [&composed](const std::string& name) {
    for (const LetDescription& one : composed.lets)
      if (one.name == name) return one.text;
    return std::string("none");
  };
  EXPECT_EQ(let("changed_target_as_read_1"), "u*(source - p)");
  EXPECT_EQ(let("changed_target_as_felt_1"), "u*(source - changed_p)");
  EXPECT_EQ(let("changed_p"), "p - changed_c");
  EXPECT_EQ(let("changed_target_size_1"),
            "if(target_at_u*(source - target_at_p) == 0, 1, (target_at_u*(source - target_at_p))/"
            "(target_at_u*(source - (target_at_p - changed_c))))");
  // What comes later acts on what the first one left.
  EffectEntry supply = OnInput("source", "constant", "source - c");
  const PlantDescription twice = Added(composed, supply);
  EXPECT_EQ(twice.modes[0].law, composed.modes[0].law);
  EXPECT_EQ(twice.modes[0].target, "u*(source - p)");
  for (const LetDescription& one : twice.lets) {
    if (one.name == "changed_target_as_felt_1") {
      EXPECT_EQ(one.text, "u*(changed_2_source - changed_p)");
    }
    if (one.name == "changed_target_as_read_1") {
      EXPECT_EQ(one.text, "u*(source - p)");
    }
  }
}

TEST(EffectComposition, ComparesTargetsThatGoToAndFroWhereTheyAreAtTheirMost) {
  // At its mean a rate is next to nothing, and an effect that adds to it would leave no error, whatever the law says.
  PlantDescription plant = Filled();
  plant.modes = {{"always", "", "k*u*head", "r"}};
  plant.parameters[0].unit = "1/s";
  EffectEntry loss = OnInput("r", "signal", "r + c*p");
  loss.forms[0].parameters[0].unit = "r/p";
  loss.forms[0].needs.push_back(Need("p", "signal", ""));
  loss.forms[0].needs[0].rate_of = "p";
  const PlantDescription composed = Added(plant, loss);
  const auto place = std::find_if(composed.constants.begin(), composed.constants.end(),
                                  [](const ConstantDescription& c) { return c.name == "target_at_r"; });
  ASSERT_NE(place, composed.constants.end());
  EXPECT_GT(std::abs(place->value), 0.0);
}

TEST(EffectComposition, TakesNoLetOfThePlantForItsOwn) {
  // Names that the lets of a split target could have.
  PlantDescription plant = Filled();
  plant.lets.push_back({"bore_size_1", "2"});
  plant.lets.push_back({"target_size_1", "3"});
  plant.lets.push_back({"target_as_read_2", "4"});
  EffectEntry bias = OnInput("p", "signal", "p - c");
  bias.forms[0].needs[0].roles = {"pressure"};
  for (const PlantDescription& composed :
       {Added(plant, bias), Added(plant, OnInput("source", "constant", "source - c"))}) {
    const auto text = [&composed](const std::string& name) {
      for (const LetDescription& one : composed.lets)
        if (one.name == name) return one.text;
      return std::string("none");
    };
    EXPECT_EQ(text("bore_size_1"), "2");
    EXPECT_EQ(text("target_size_1"), "3");
    EXPECT_EQ(text("target_as_read_2"), "4");
  }
}

}  // namespace
}  // namespace armcmc::effect_composition_test
