// To what in a plant an effect can be attached, and what is wrong with an effect that cannot be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "armcmc/plant/effect.hpp"
#include "armcmc/plant/error.hpp"
#include "armcmc/plant/plant.hpp"
#include "core/plant/effect_entries.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::effect_bindings_test {
namespace {

using test::Added;
using test::Filled;
using test::Friction;
using test::Need;
using test::OnInput;
using test::WithTerm;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

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
    EXPECT_THAT(error.what(), HasSubstr("units do not match"));
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
        Wrong{"UnknownSize", [](auto* f) { f->parameters[0].sd = "0.5*outptu"; }, "parameters.Fc.sd", 5,
              "is not a known size"},
        Wrong{"UnitThatIsNone", [](auto* f) { f->parameters[0].unit = "outptu"; }, "parameters.Fc.unit", 0, "outptu"},
        Wrong{"NothingSaysWhatNothingIs", [](auto* f) { f->parameters[0].none = ""; }, "parameters", 0, "`none`"},
        Wrong{"UnusedParameter", [](auto* f) { f->terms[0].formula = "v"; }, "parameters.Fc", 0, "not used"},
        Wrong{"ReservedName", [](auto* f) { f->needs[0].name = "law"; }, "needs.law", 0, "cannot be a name"},
        Wrong{"SameNameTwice", [](auto* f) { f->parameters[0].name = "v"; }, "parameters.v", 0, "already"},
        Wrong{"UnknownKind", [](auto* f) { f->needs[0].kind = "column"; }, "needs.v.kind", 0, "signal, state"},
        Wrong{"ReadsNoNeed", [](auto* f) { f->needs[0].per = "y"; }, "needs.v.per", 0, "expected v"}),
    [](const auto& at) { return std::string(at.param.name); });

}  // namespace
}  // namespace armcmc::effect_bindings_test
