#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "core/effects/contact_series.hpp"
#include "plants/hunt_crossley/effects.hpp"
#include "plants/hunt_crossley/model.hpp"

namespace armcmc::effect_settings_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string ErrorOf(const EstimatorSettings& settings) {
  try {
    settings.Validate();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

EstimatorSettings With(std::initializer_list<const char*> names) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  for (const char* name : names)
    settings.effects[static_cast<std::size_t>(settings.num_effects++)] = MakeEffect(HuntCrossley::kInfo, name);
  return settings;
}

TEST(EffectSettings, TheCatalogueIsValidAtAnyScale) {
  for (const EffectInfo* info : ContactEffects::kInfos)
    for (const ContactScales& scales : {ContactScales{}, ContactScales{5.0, 2e-3, 0.01, 0.3, 10.0}}) {
      EstimatorSettings settings = BuiltinSettings("hunt_crossley");
      settings.effects[0] = MakeEffect(HuntCrossley::kInfo, std::string(info->name), scales);
      settings.num_effects = 1;
      EXPECT_EQ(ErrorOf(settings), "") << info->name;
      EXPECT_FALSE(info->family.empty());
      EXPECT_FALSE(info->formula.empty());
    }
}

TEST(EffectSettings, PriorsFollowTheSizeOfTheData) {
  const EffectSettings small =
      MakeEffect(HuntCrossley::kInfo, "viscous_friction", ContactScales{.force = 2.0, .speed = 0.01});
  EXPECT_DOUBLE_EQ(small.amplitudes[0].sd, 0.2 * 2.0 / 0.01);
  EXPECT_EQ(small.amplitudes[0].lower, 0.0);
  EXPECT_DOUBLE_EQ(MakeEffect(HuntCrossley::kInfo, "adhesion", ContactScales{.length = 1e-3}).shapes[0], 0.2e-3);
}

TEST(EffectSettings, UnknownNameListsTheCatalogue) {
  try {
    (void)MakeEffect(HuntCrossley::kInfo, "stiction");
    ADD_FAILURE();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("stiction"), HasSubstr("coulomb_friction, presliding_friction")));
  }
}

TEST(EffectSettings, RefusesWhatCannotBeSampled) {
  EXPECT_EQ(ErrorOf(With({"force_bias", "force_drift", "inertia", "sensor_lag", "adhesion"})), "");
  EXPECT_THAT(ErrorOf(With({"periodic_disturbance", "force_drift", "inertia", "sensor_lag", "adhesion"})),
              AllOf(HasSubstr("9"), HasSubstr("at most 8")));
  EstimatorSettings settings = With({"force_bias", "force_drift", "inertia", "sensor_lag", "adhesion"});
  settings.noise[0].estimate_std = true;
  EXPECT_THAT(ErrorOf(settings), HasSubstr("at most 8")) << "the noise scale is a coordinate too";
}

TEST(EffectSettings, NamesTheKeyThatIsWrong) {
  EXPECT_THAT(ErrorOf(With({"force_bias", "force_bias"})), HasSubstr("'force_bias' is named twice"));
  EstimatorSettings s = With({"coulomb_friction"});
  s.effects[0].shapes[0] = 0.0;
  EXPECT_THAT(ErrorOf(s), HasSubstr("effect.coulomb_friction.speed = 0"));
  s = With({"coulomb_friction"});
  s.effects[0].amplitudes[0].lower = -1.0;
  EXPECT_THAT(ErrorOf(s), HasSubstr("effect.coulomb_friction.force.lower = -1")) << "friction does not push";
  s = With({"coulomb_friction"});
  s.effects[0].amplitudes[0].sd = 0.0;
  EXPECT_THAT(ErrorOf(s), HasSubstr("effect.coulomb_friction.force.sd = 0"));
  s = With({"force_bias"});
  s.effects[0].gate = EffectGate::kFrom;
  s.effects[0].from_s = std::nan("");
  EXPECT_THAT(ErrorOf(s), HasSubstr("effect.force_bias.from_s"));
  s = With({"force_bias"});
  s.effects[0].name = "bias";
  EXPECT_THAT(ErrorOf(s), HasSubstr("effect.name = 'bias'"));
  EstimatorSettings actuator = BuiltinSettings("soft_actuator");
  actuator.effects[0] = MakeEffect(HuntCrossley::kInfo, "force_bias");
  actuator.num_effects = 1;
  EXPECT_THAT(ErrorOf(actuator), AllOf(HasSubstr("'force_bias' is not an effect of soft_actuator"), HasSubstr("leak")));
}

}  // namespace
}  // namespace armcmc::effect_settings_test
