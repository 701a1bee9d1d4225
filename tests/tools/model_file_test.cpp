#include "armcmc/support/model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "armcmc/support/estimator_config.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"
#include "plants/hunt_crossley/effects.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "support/paths.hpp"

namespace armcmc::support::model_file_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ModelFile : public ::testing::Test {
 protected:
  std::string Write(const std::string& text) {
    const std::string path = dir_ / "model.toml";
    std::ofstream(path) << text;
    return path;
  }
  std::string ErrorOf(const std::string& text) {
    try {
      (void)ReadModel(Write(text));
    } catch (const ConfigError& error) {
      return error.what();
    }
    ADD_FAILURE() << "no ConfigError was thrown for:\n" << text;
    return "";
  }
  test::ScratchDir dir_;
};

void ExpectSamePrior(const ParameterSettings& a, const ParameterSettings& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.prior, b.prior) << a.name;
  if (a.prior == PriorKind::kNormal) {
    EXPECT_EQ(a.mean, b.mean) << a.name;
    EXPECT_EQ(a.sd, b.sd) << a.name;
  }
  EXPECT_EQ(a.lower, b.lower) << a.name;
  EXPECT_EQ(a.upper, b.upper) << a.name;
}

void ExpectSameModel(const EstimatorSettings& a, const EstimatorSettings& b) {
  EXPECT_EQ(a.model, b.model);
  for (std::size_t d = 0; d < static_cast<std::size_t>(a.num_parameters); ++d)
    ExpectSamePrior(a.parameters[d], b.parameters[d]);
  EXPECT_EQ(a.constants, b.constants);
  EXPECT_EQ(a.regress_rate, b.regress_rate);
  EXPECT_EQ(a.noise[0].kind, b.noise[0].kind);
  EXPECT_EQ(a.noise[0].std, b.noise[0].std);
  EXPECT_EQ(a.noise[0].estimate_std, b.noise[0].estimate_std);
  EXPECT_EQ(a.noise[0].outlier_scale, b.noise[0].outlier_scale);
  ASSERT_EQ(a.num_effects, b.num_effects);
  for (std::size_t e = 0; e < static_cast<std::size_t>(a.num_effects); ++e) {
    const EffectSettings &p = a.effects[e], &q = b.effects[e];
    EXPECT_EQ(p.name, q.name);
    EXPECT_EQ(p.gate, q.gate) << p.name;
    EXPECT_EQ(p.from_s, q.from_s) << p.name;
    EXPECT_EQ(p.until_s, q.until_s) << p.name;
    EXPECT_EQ(p.shapes, q.shapes) << p.name;
    for (std::size_t i = 0; i < p.amplitudes.size(); ++i) ExpectSamePrior(p.amplitudes[i], q.amplitudes[i]);
  }
}

TEST_F(ModelFile, EveryEffectReadsBackToTheBit) {
  int k = 0;
  for (const EffectInfo* info : ContactEffects::kInfos) {
    EstimatorSettings settings = BuiltinSettings("hunt_crossley");
    settings.parameters[0].mean = 1.0 / 3.0;
    settings.parameters[2].prior = PriorKind::kUniform;
    settings.noise[0].kind = NoiseKind::kMixture;
    settings.noise[0].std = 0.1 + 1e-17 * k;
    settings.noise[0].estimate_std = k % 2 == 0;
    EffectSettings& effect = settings.effects[0];
    effect = MakeEffect(HuntCrossley::kInfo, std::string(info->name),
                        ContactScales{.force = 0.7, .length = 3e-3, .speed = 0.011});
    effect.gate = static_cast<EffectGate>(k++ % 5);
    effect.from_s = effect.gate == EffectGate::kFrom ? 12.1 : 0.0;
    effect.until_s = effect.gate == EffectGate::kUntil ? 7.3 : 0.0;
    settings.num_effects = 1;
    if (info->name != "force_bias") {
      settings.effects[1] = MakeEffect(HuntCrossley::kInfo, "force_bias");
      settings.num_effects = 2;
    }
    ExpectSameModel(ReadModel(Write(ModelFileText(settings))), settings);
  }
}

TEST_F(ModelFile, TheActuatorReadsBack) {
  EstimatorSettings settings = BuiltinSettings("soft_actuator_excited");
  for (const bool regress_rate : {true, false}) {
    settings.regress_rate = regress_rate;
    ExpectSameModel(ReadModel(Write(ModelFileText(settings))), settings);
  }
}

TEST_F(ModelFile, ABuiltInNameIsAModelToo) {
  ExpectSameModel(ReadModel("hunt_crossley"), BuiltinSettings("hunt_crossley"));
  EXPECT_FALSE(IsModelFile("hunt_crossley"));
  EXPECT_TRUE(IsModelFile("nowhere.toml"));
  EXPECT_THROW((void)ReadModel("hunt_crossly"), ConfigError);
  EXPECT_THROW((void)ReadModel("nowhere.toml"), ConfigError);
}

TEST_F(ModelFile, ReplacesTheModelOfAConfigurationAndNothingElse) {
  const std::string path = Write(R"(schema = 1
base = "hunt_crossley"
[parameters.K]
mean = 4.0
sd = 0.1
[[effect]]
name = "coulomb_friction"
when = "contact"
speed = 0.5
force = { mean = 0.4, sd = 0.1, upper = 3.0 }
)");
  StrictTable root = StrictTable::FromText(R"(schema = 1
[model]
name = "soft_actuator"
[model.parameters.K]
mean = 2.0
[model.parameters.B]
mean = 1.0
[sampler]
seed = 7
)",
                                           "f.toml");
  const EstimatorSettings settings = ReadEstimatorSettings(root, path);
  root.Finish();
  EXPECT_EQ(settings.model, "hunt_crossley");
  EXPECT_EQ(settings.parameters[0].mean, 4.0);
  EXPECT_EQ(settings.parameters[1].mean, 1.0) << "the model file says nothing about B";
  EXPECT_EQ(settings.sampler.seed, 7u);
  ASSERT_EQ(settings.num_effects, 1);
  EXPECT_EQ(settings.effects[0].gate, EffectGate::kContact);
  EXPECT_EQ(settings.effects[0].shapes[0], 0.5);
  EXPECT_EQ(settings.effects[0].amplitudes[0].mean, 0.4);
  EXPECT_EQ(settings.effects[0].amplitudes[0].lower, 0.0);
  EXPECT_EQ(settings.effects[0].amplitudes[0].upper, 3.0);
}

TEST_F(ModelFile, AConfigurationMayNameEffectsItself) {
  StrictTable root = StrictTable::FromText(
      "schema = 1\n[model]\nname = \"hunt_crossley\"\n[[effect]]\nname = \"force_bias\"\nfrom_s = 3\n", "f.toml");
  const EstimatorSettings settings = ReadEstimatorSettings(root, "");
  root.Finish();
  ASSERT_EQ(settings.num_effects, 1);
  EXPECT_EQ(settings.effects[0].gate, EffectGate::kFrom);
  EXPECT_EQ(settings.effects[0].from_s, 3.0);
}

TEST_F(ModelFile, SaysWhatIsWrongAndWhere) {
  const std::string start = "schema = 1\nbase = \"hunt_crossley\"\n";
  EXPECT_THAT(ErrorOf("schema = 2\nbase = \"hunt_crossley\"\n"), HasSubstr("schema = 2"));
  EXPECT_THAT(ErrorOf("schema = 1\nbase = \"hunt\"\n"), AllOf(HasSubstr("model.toml:2"), HasSubstr("base")));
  EXPECT_THAT(ErrorOf(start + "[[effect]]\nname = \"stiction\"\n"),
              AllOf(HasSubstr("model.toml:4"), HasSubstr("stiction"), HasSubstr("coulomb_friction")));
  EXPECT_THAT(ErrorOf(start + "[[effect]]\nname = \"force_bias\"\nspeed = 1.0\n"), HasSubstr("model.toml:5"));
  EXPECT_THAT(ErrorOf(start + "[[effect]]\nname = \"coulomb_friction\"\nspeed = -1.0\n"),
              AllOf(HasSubstr("model.toml:5"), HasSubstr("speed = -1")));
  EXPECT_THAT(ErrorOf(start + "[[effect]]\nname = \"force_bias\"\nwhen = \"contact\"\nfrom_s = 1.0\n"),
              HasSubstr("not both"));
  EXPECT_THAT(ErrorOf(start + "[[effect]]\nname = \"force_bias\"\nuntil_s = 2.0\nfrom_s = 1.0\n"),
              HasSubstr("not both"));
  EXPECT_THAT(ErrorOf(start + "[[effect]]\nname = \"force_bias\"\nwhen = \"never\"\n"), HasSubstr("never"));
  EXPECT_THAT(ErrorOf(start + "[[effect]]\nname = \"viscous_friction\"\ncoefficient = { lower = -1.0 }\n"),
              HasSubstr("effect.viscous_friction.coefficient.lower = -1"));
  EXPECT_THAT(ErrorOf("schema = 1\nbase = \"soft_actuator\"\n[[effect]]\nname = \"force_bias\"\n"),
              HasSubstr("expected one of pressure_bias"));
}

}  // namespace
}  // namespace armcmc::support::model_file_test
