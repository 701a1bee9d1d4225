#include "armcmc/plant/effect.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "armcmc/expression/error.hpp"
#include "armcmc/plant/plant.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::effect_composition_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::UnorderedElementsAre;

EffectNeed Need(const std::string& name, const std::string& kind, const std::string& role) {
  EffectNeed need;
  need.name = name;
  need.kind = kind;
  if (!role.empty()) need.roles = {role};
  return need;
}

EffectParameter Amplitude(const std::string& name, const std::string& unit, const std::string& sd) {
  EffectParameter p;
  p.name = name;
  p.unit = unit;
  p.sd = sd;
  p.none = "0";
  return p;
}

/// Dry friction as the catalogue has it.
EffectEntry Friction() {
  EffectEntry entry;
  entry.name = "friction";
  entry.title = "Dry friction";
  entry.family = "dry friction";
  EffectForm form;
  form.explains = {"force"};
  form.needs = {Need("v", "signal", "velocity")};
  form.terms = {{"output", "", "Fc*sign(v)"}};
  form.parameters = {Amplitude("Fc", "output", "0.5*output")};
  form.parameters[0].lower = "0";
  entry.forms = {form};
  return entry;
}

EffectEntry WithTerm(const std::string& slot, const std::string& formula, const std::string& unit = "1") {
  EffectEntry entry = Friction();
  entry.name = "changed";
  entry.forms[0].needs.clear();
  entry.forms[0].terms = {{slot, "", formula}};
  entry.forms[0].parameters = {Amplitude("c", unit, "1")};
  return entry;
}

PlantDescription Added(const PlantDescription& plant, const EffectEntry& entry) {
  return AddEffect(plant, entry, Bindings(plant, entry).at(0), DefaultScales(plant));
}

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

/// A tank behind a valve: its law explains what the valve lets in.
PlantDescription Filled() {
  PlantDescription plant;
  plant.name = "filled";
  plant.output = "y";
  plant.signals = {{"u", "1", "drive", ""}, {"p", "Pa", "pressure", ""}, {"r", "Pa/s", "", "p"}, {"y", "m", "", ""}};
  plant.constants = {{"source", 5e5, "Pa"}};
  plant.parameters = {{"k", "s", "normal", 1.0, 1.0, 0.0, 10.0}};
  plant.lets = {{"head", "source - p"}};
  plant.modes = {{"open", "u > 0", "k*r", "u*head"}, {"shut", "", "", "", true}};
  return plant;
}

EffectEntry OnInput(const std::string& name, const std::string& kind, const std::string& formula) {
  EffectEntry entry = WithTerm(kind == "constant" ? "parameter" : "input", formula, name);
  entry.forms[0].explains.clear();
  entry.forms[0].needs = {Need(name, kind, "")};
  entry.forms[0].needs[0].used = true;
  entry.forms[0].terms[0].of = name;
  return entry;
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

TEST(EffectBindings, KnowWhichSignalIsTheRateOfWhich) {
  EffectEntry loss = OnInput("r", "signal", "r + c*p");
  loss.forms[0].parameters[0].unit = "r/p";
  loss.forms[0].needs.push_back(Need("p", "signal", ""));
  loss.forms[0].needs[0].rate_of = "p";
  const auto bindings = Bindings(Filled(), loss);
  ASSERT_EQ(bindings.size(), 1u);
  EXPECT_THAT(bindings[0].symbols, UnorderedElementsAre(Pair("r", "r"), Pair("p", "p")));
}

TEST(EffectBindings, AreAllWaysInWhichTheRolesFit) {
  PlantDescription plant = test::DescribedAxis();
  plant.signals.push_back({"v2", "m/s", "velocity", ""});
  std::vector<std::string> bound;
  for (const EffectBinding& binding : Bindings(plant, Friction())) bound.push_back(binding.symbols.at("v"));
  EXPECT_THAT(bound, ElementsAre("v", "v2"));
}

TEST(EffectBindings, UseTheFirstFormThatFitsAndEveryVariant) {
  EffectEntry entry = Friction();
  EffectForm rate = entry.forms[0];
  rate.explains.clear();
  rate.needs[0].kind = "state";
  rate.terms = {{"rate", "v", "-Fc*sign(v)"}};
  rate.parameters[0].unit = "v/s";
  EffectForm variant = entry.forms[0];
  variant.variant = true;
  variant.name = "other";
  entry.forms = {entry.forms[0], rate, entry.forms[0], variant};
  std::vector<std::size_t> forms;
  for (const EffectBinding& binding : Bindings(test::DescribedAxis(), entry)) forms.push_back(binding.form);
  EXPECT_THAT(forms, ElementsAre(0u, 3u)) << "not the third, which fits as well";
  EXPECT_EQ(Bindings(test::SimulatedSpring(), entry).at(0).form, 1u)
      << "its output is a position, its velocity a state";
}

TEST(EffectBindings, AreNoneWhereTheOutputIsSomethingElseOrTheLawDoesNotRead) {
  EXPECT_TRUE(Bindings(test::SimulatedSpring(), Friction()).empty());
  EXPECT_THAT(WhyNot(test::SimulatedSpring(), Friction()), HasSubstr("its output would be a force"));
  EffectEntry contact = Friction();
  contact.forms[0].needs = {Need("v", "signal", "position")};
  contact.forms[0].needs[0].used = true;
  PlantDescription axis = test::DescribedAxis();
  axis.signals.push_back({"q", "m", "position", ""});
  EXPECT_TRUE(Bindings(axis, contact).empty()) << "a force that does not depend on the position";
  EXPECT_THAT(WhyNot(axis, contact), HasSubstr("the role position that the law reads"));
  EXPECT_EQ(Bindings(test::DescribedContact(), contact).size(), 1u);
}

TEST(EffectBindings, FindAStiffnessByItsUnitWhateverItsPower) {
  EffectEntry entry = WithTerm("parameter", "k*(1 + c*t)", "1/s");
  entry.forms[0].needs = {Need("x", "signal", "position"), Need("k", "parameter", "")};
  entry.forms[0].needs[1].per = "x";
  entry.forms[0].terms[0].of = "k";
  const auto bindings = Bindings(test::DescribedContact(), entry);
  ASSERT_EQ(bindings.size(), 1u);
  EXPECT_THAT(bindings[0].symbols, UnorderedElementsAre(Pair("x", "x"), Pair("k", "K")));
}

TEST(EffectBindings, OfAStateThatFeedsAnotherReadItsRate) {
  EffectEntry entry = WithTerm("rate", "-c*x", "v/s/x");
  entry.forms[0].explains.clear();
  entry.forms[0].needs = {Need("v", "state", "velocity"), Need("x", "state", "position")};
  entry.forms[0].needs[1].reads = "v";
  entry.forms[0].terms[0].of = "v";
  EXPECT_EQ(Bindings(test::SimulatedSpring(), entry).size(), 1u);
  PlantDescription other = test::SimulatedSpring();
  other.states[0].rate = "0*u*1 + 0*t*pos";  // reads itself, not the velocity
  EXPECT_TRUE(Bindings(other, entry).empty());
}

TEST(EffectErrors, OfACompositionSayWhichTextItGives) {
  EffectEntry entry = Friction();
  entry.forms[0].parameters[0].unit = "output/v";
  try {
    (void)Added(test::DescribedAxis(), entry);
    FAIL() << "a velocity was added to a force";
  } catch (const PlantError& error) {
    EXPECT_THAT(error.what(), HasSubstr("friction in axis gives law = \"M*a + Fv*v + off + friction_Fc*sign(v)\""));
    EXPECT_THAT(error.what(), HasSubstr("units do not fit"));
  }
}

TEST(EffectErrors, OfABindingThatDoesNotFit) {
  EXPECT_THROW(
      (void)AddEffect(test::DescribedAxis(), Friction(), {0, {{"v", "a"}}}, DefaultScales(test::DescribedAxis())),
      PlantError);
}

struct Wrong {
  const char* name;
  std::function<void(EffectForm*)> spoil;
  const char* key;
  int column;
  const char* what;
};

class WrongEntry : public ::testing::TestWithParam<Wrong> {};

TEST_P(WrongEntry, IsFoundBeforeAnyPlantIsAtHand) {
  EffectEntry entry = Friction();
  GetParam().spoil(&entry.forms[0]);
  try {
    CheckEffect(entry);
    FAIL() << "passed";
  } catch (const PlantError& error) {
    EXPECT_EQ(error.key(), GetParam().key);
    EXPECT_EQ(error.column(), GetParam().column);
    EXPECT_THAT(error.what(), HasSubstr(GetParam().what));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Friction, WrongEntry,
    ::testing::Values(
        Wrong{"UnknownName", [](auto* f) { f->terms[0].formula = "Fc*sign(w)"; }, "formula", 9, "\"w\" is neither"},
        Wrong{"UnknownFunction", [](auto* f) { f->terms[0].formula = "Fc*sgn(v)"; }, "formula", 4, "sgn"},
        Wrong{"Syntax", [](auto* f) { f->terms[0].formula = "Fc*("; }, "formula", 5, "expected"},
        Wrong{"UnknownSlot", [](auto* f) { f->terms[0].slot = "force"; }, "slot", 0, "expected output, law"},
        Wrong{"RateOfNothing", [](auto* f) { f->terms[0].slot = "rate"; }, "of", 0, "that is a state"},
        Wrong{"UnknownSize", [](auto* f) { f->parameters[0].sd = "0.5*outptu"; }, "parameters.Fc.sd", 5, "is no size"},
        Wrong{"UnitThatIsNone", [](auto* f) { f->parameters[0].unit = "outptu"; }, "parameters.Fc.unit", 0, "outptu"},
        Wrong{"NothingSaysWhatNothingIs", [](auto* f) { f->parameters[0].none = ""; }, "parameters", 0, "`none`"},
        Wrong{"UnusedParameter", [](auto* f) { f->terms[0].formula = "v"; }, "parameters.Fc", 0, "used nowhere"},
        Wrong{"ReservedName", [](auto* f) { f->needs[0].name = "law"; }, "needs.law", 0, "cannot be a name"},
        Wrong{"SameNameTwice", [](auto* f) { f->parameters[0].name = "v"; }, "parameters.v", 0, "already"},
        Wrong{"UnknownKind", [](auto* f) { f->needs[0].kind = "column"; }, "needs.v.kind", 0, "signal, state"},
        Wrong{"ReadsNoNeed", [](auto* f) { f->needs[0].per = "y"; }, "needs.v.per", 0, "expected v"}),
    [](const auto& at) { return std::string(at.param.name); });

}  // namespace
}  // namespace armcmc::effect_composition_test
