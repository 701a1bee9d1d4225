// Effects as files, in plant files, and plants with effects as files.

#include "armcmc/support/effect_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "armcmc/support/effect_library.hpp"
#include "armcmc/support/effect_request.hpp"
#include "armcmc/support/plant_file.hpp"
#include "armcmc/support/plant_writer.hpp"
#include "support/paths.hpp"

namespace armcmc::support::effect_file_test {
namespace {

using testing::HasSubstr;

constexpr const char* kEntry = R"TOML(schema = 1
name = "wind"
title = "Wind on a sail"
family = "wind"
kin = ["drag"]
experiment = "Sail."
slot = "output"
formula = "c*v*abs(v)"

[needs]
v = { role = ["velocity", "speed"] }

[parameters]
c = { unit = "output/v^2", sd = "0.5*output/v^2", none = 0 }

[[variant]]
name = "gusts"
title = "Wind that comes in gusts"
formula = "g*sin(w*t)"

[variant.parameters]
g = { unit = "output", sd = "output", none = "0" }
w = { unit = "1/s", prior = "lognormal", mean = 3.5, sd = "1" }
)TOML";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), std::string::npos) << from;
  return text.replace(text.find(from), from.size(), to);
}

std::string AxisText() {
  std::ifstream file(test::SourceDir() / "core/plants/servo_axis/plant.toml");
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string ErrorOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(EffectFile, IsWhatItSays) {
  const EffectEntry entry = EffectFromText(kEntry, "wind.toml");
  EXPECT_EQ(entry.name, "wind");
  ASSERT_EQ(entry.forms.size(), 2u);
  EXPECT_EQ(entry.forms[0].needs[0].roles, (std::vector<std::string>{"velocity", "speed"}));
  EXPECT_EQ(entry.forms[0].parameters[0].none, "0");
  EXPECT_TRUE(entry.forms[1].variant);
  EXPECT_EQ(entry.forms[1].parameters[1].mean, "3.5");
}

struct Wrong {
  const char* name;
  const char* from;
  const char* to;
  const char* expected;
};

class WrongEffect : public ::testing::TestWithParam<Wrong> {};

TEST_P(WrongEffect, SaysWhereAndWhatWasExpected) {
  const std::string text = Replaced(kEntry, GetParam().from, GetParam().to);
  EXPECT_THAT(ErrorOf([&] { (void)EffectFromText(text, "wind.toml"); }), HasSubstr(GetParam().expected));
}

INSTANTIATE_TEST_SUITE_P(
    Wind, WrongEffect,
    ::testing::Values(Wrong{"Name", "abs(v)", "abs(w)", "wind.toml:8:20: formula = \"c*v*abs(w)\": \"w\" is neither"},
                      Wrong{"NameOfAVariant", "sin(w*t)", "sin(v*t)", "wind.toml:19:18: variant[0].formula"},
                      Wrong{"Key", "experiment", "experimant", "wind.toml:6:"},
                      Wrong{"KeyOfAParameter", "none = 0", "nome = 0", "nome: unknown key (did you mean none?)"},
                      Wrong{"Size", "0.5*output/v^2\"", "0.5*outptu\"", "wind.toml:14:"},
                      Wrong{"Slot", "slot = \"output\"", "slot = \"ouput\"", "(did you mean output?)"},
                      Wrong{"NoTitle", "title = \"Wind on a sail\"\n", "", "title is missing"},
                      Wrong{"NotOnlineWithoutReason", "slot =", "online = false\nslot =", "says why: reason"}),
    [](const auto& at) { return std::string(at.param.name); });

TEST(EffectLibrary, IsTheFolderBesideTheProgramsAndKnowsOtherNames) {
  const std::vector<EffectEntry> entries = ReadEffectLibrary();
  EXPECT_GE(entries.size(), 36u);
  EXPECT_EQ(FindEffect(entries, "force_bias", "").name, "output_bias");
  EXPECT_THAT(ErrorOf([&] { (void)FindEffect(entries, "coulomb_fricton", "use: "); }),
              HasSubstr("use: no effect is called \"coulomb_fricton\" (did you mean coulomb_friction?); available: "));
}

TEST(EffectRequestWord, NamesAVariantAndWhatItActsOn) {
  const EffectRequest request = RequestFromWord("overflow:both:x=high");
  EXPECT_EQ(request.name, "overflow");
  EXPECT_EQ(request.variant, "both");
  EXPECT_EQ(request.bind.at("x"), "high");
  for (const char* wrong : {"", ":x=high", "overflow:", "overflow:a:b", "overflow:=high"})
    EXPECT_NE(ErrorOf([&] { (void)RequestFromWord(wrong); }), "no error") << wrong;
}

TEST(PlantFileEffects, AreInThePlantAndTheBaseIsWithout) {
  const test::ScratchDir dir;
  std::ofstream(dir / "axis.toml") << AxisText() << R"(
[effects]
use = ["presliding_friction", { name = "coulomb_friction", Fc = { mean = 12.5, sd = 2.0 } }]
without = ["inertia"]
)";
  const PlantFile file = ReadPlantFile(dir / "axis.toml");
  EXPECT_EQ(file.base.law, "M*a + Fv*v + off");
  const PlantDescription& plant = file.plant.description();
  EXPECT_EQ(plant.law, "M*a + Fv*v + off + presliding_friction_Fc*presliding_friction_z + coulomb_friction_Fc*sign(v)");
  EXPECT_EQ(plant.parameters.back().mean, 12.5);
  EXPECT_EQ(plant.parameters.back().sd, 2.0);
  EXPECT_EQ(file.effects.without, std::vector<std::string>{"inertia"});
}

TEST(PlantFileEffects, OfOneSOwnStandBesideAndBeforeTheCatalogue) {
  const test::ScratchDir dir;
  const std::filesystem::path path = dir / "axis.toml";
  const std::string own = R"(
[effects]
use = ["drag", "coulomb_friction"]

[[effect]]
name = "drag"
title = "Drag of my own"
family = "viscous friction"
formula = "c*v^3"
needs = { v = { role = "velocity" } }
parameters = { c = { unit = "output/v^3", sd = "output/v^3", none = "0" } }
)";
  const Plant plant = PlantFromText(AxisText() + own, "axis.toml");
  EXPECT_EQ(plant.description().law, "M*a + Fv*v + off + drag_c*v^3 + coulomb_friction_Fc*sign(v)");
  std::ofstream(path) << AxisText() << own;
  int drags = 0;
  for (const EffectEntry& entry : EffectsFor(ReadPlantFile(path).effects)) drags += entry.name == "drag" ? 1 : 0;
  EXPECT_EQ(drags, 1) << "that of the catalogue is replaced";
  const std::string wrong = Replaced(own, "c*v^3", "c*w^3");
  EXPECT_THAT(ErrorOf([&] { (void)PlantFromText(AxisText() + wrong, "axis.toml"); }),
              HasSubstr("axis.toml:30:14: effect[0].formula = \"c*w^3\": \"w\" is neither"));
}

TEST(PlantFileEffects, ThatDoNotFitOrAreNoneAreErrorsWithTheirPlace) {
  const auto error = [&](const std::string& effects) {
    return ErrorOf([&] { (void)PlantFromText(AxisText() + "\n[effects]\n" + effects + "\n", "axis.toml"); });
  };
  EXPECT_THAT(error("use = [\"coulomb_fricton\"]"), HasSubstr("axis.toml:24:7: effects.use"));
  EXPECT_THAT(error("use = [\"coulomb_fricton\"]"), HasSubstr("did you mean coulomb_friction?"));
  EXPECT_THAT(error("use = [\"overflow\"]"), HasSubstr("overflow does not fit servo_axis: it has no state"));
  EXPECT_THAT(error("without = [\"inerta\"]"), HasSubstr("did you mean inertia?"));
  EXPECT_THAT(error("use = [{ name = \"coulomb_friction\", F = { mean = 1.0 } }]"),
              HasSubstr("has no parameter \"F\""));
  EXPECT_THAT(error("use = [{ name = \"coulomb_friction\", variant = \"smoth\" }]"), HasSubstr("did you mean smooth?"));
  EXPECT_THAT(error("use = [3]"), HasSubstr("effects.use = 3: expected a name in quotes"));
  EXPECT_THAT(error("uses = []"), HasSubstr("effects.uses: unknown key"));
}

TEST(PlantFileEffects, ThatFitInSeveralWaysAskWhich) {
  std::ifstream stream(test::SourceDir() / "core/plants/two_tanks/plant.toml");
  const std::string tanks{std::istreambuf_iterator<char>(stream), {}};
  const auto with = [&](const std::string& use) {
    return PlantFromText(tanks + "\n[effects]\nuse = [" + use + "]\n", "tanks.toml");
  };
  EXPECT_THAT(ErrorOf([&] { (void)with("\"linear_loss\""); }), HasSubstr("say which: x = high; or x = low"));
  const Plant plant = with("{ name = \"linear_loss\", bind = { x = \"low\" } }");
  EXPECT_THAT(plant.description().states[1].rate, HasSubstr(" - linear_loss_c*low"));
  EXPECT_EQ(with("\"overflow\"").description().states.size(), 2u);
}

TEST(PlantWriter, WritesWhatIsReadAgainWhateverStandsInIt) {
  PlantDescription plant = PlantFromText(AxisText(), "axis.toml").description();
  plant.title = "A \"quoted\" title, a \\ and\ttabs \u00b5m";
  plant.constants = {{"c1", 1e300, "m"}, {"c2", -0.1, ""}, {"c3", 123456789012345678.0, ""}};
  plant.parameters[0].mean = 1.0 / 3.0;
  plant.parameters.push_back({"n", "1", "lognormal", 2.5, 0.125});
  plant.parameters.push_back({"u", "1", "uniform", 0.0, 0.0, -1e-30, 7.0});
  plant.lets = {{"twice", "2*v"}};
  plant.law = "M*a + Fv*v + off*(n + u + 0*c1*twice/c1/v) + 0*c2*off + 0*c3*off";
  plant.modes.clear();
  plant.reports = {{"weight", "N", "9.81*M*1"}};
  plant.reports.clear();
  const Plant original(plant);
  const Plant read = PlantFromText(PlantFileText(plant, "first\nsecond"), "written");
  EXPECT_EQ(read.identity(), original.identity());
  EXPECT_EQ(read.description().title, plant.title);
  EXPECT_EQ(read.description().parameters[0].mean, plant.parameters[0].mean);
  EXPECT_EQ(*read.description().parameters.back().lower, -1e-30);
  EXPECT_EQ(read.description().constants[0].unit, "m");
  EXPECT_EQ(read.description().constants[2].value, plant.constants[2].value);
  EXPECT_EQ(read.description().noise.estimate, plant.noise.estimate);
}

}  // namespace
}  // namespace armcmc::support::effect_file_test
