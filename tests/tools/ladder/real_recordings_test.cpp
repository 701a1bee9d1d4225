// Recordings of real plants, whose data stay outside: the documented effect is named first and the error shrinks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::real_recordings_test {
namespace {

/// What armcmc-gap finds in a recording.
Json ResultOf(const std::string& recording, const std::string& data, const std::string& without) {
  const ScratchDir dir;
  std::vector<std::string> arguments{"--recording", SourceDir() / "tools" / "gap" / "recordings" / recording,
                                     "--data-dir",  FindData("measured/" + data)->parent_path(),
                                     "--out",       dir / "out"};
  if (!without.empty()) arguments.insert(arguments.end(), {"--without", without});
  const Outcome run = RunProgram(Program("armcmc-gap"), arguments);
  EXPECT_EQ(run.code, 0) << run.err;
  return ReadJson(dir / "out" / "result.json");
}

std::vector<std::string> NamesOn(const Json& rung) {
  std::vector<std::string> names;
  for (std::size_t n = 0; n < rung["effects"].size(); ++n) names.push_back(rung["effects"][n].text());
  return names;
}

/// A recording with a documented effect.
struct Real {
  const char* recording;
  const char* data;
  std::vector<std::string> first;  ///< One of these is on the first rung.
  double error;                    ///< At most, on the rows kept apart, unit of the output.
};

class RealRecording : public ::testing::TestWithParam<Real> {};

TEST_P(RealRecording, NamesTheDocumentedEffect) {
  ARMCMC_REQUIRE_DATA(std::string("measured/") + GetParam().data);
  const Json result = ResultOf(GetParam().recording, GetParam().data, "");
  ASSERT_FALSE(result["ladder"].empty());
  const std::vector<std::string> first = NamesOn(result["ladder"][0]);
  EXPECT_TRUE(std::any_of(first.begin(), first.end(), [](const std::string& name) {
    return std::find(GetParam().first.begin(), GetParam().first.end(), name) != GetParam().first.end();
  })) << ::testing::PrintToString(first);
  EXPECT_LT(result["gap"]["heldout_rmse_after"].get<double>(), GetParam().error);
  // The estimator runs the new model, and its predictions one pack ahead are better, too.
  const Json& step = result["one_step"];
  ASSERT_TRUE(step["after"].is_object()) << step.dump();
  EXPECT_LT(step["after"]["rmse"].get<double>(), step["before"]["rmse"].get<double>());
  EXPECT_LT(step["after"]["kept_apart"]["rmse"].get<double>(), step["before"]["kept_apart"]["rmse"].get<double>());
}

/// The same without what is documented.
struct Control {
  const char* recording;
  const char* data;
  const char* without;
  std::vector<std::string> may;  ///< Be named: of the same family, or there as well.
};

class RealControl : public ::testing::TestWithParam<Control> {};

TEST_P(RealControl, WithTheDocumentedEffectOutOfTheCatalogueThereIsNoFalseFamily) {
  ARMCMC_REQUIRE_DATA(std::string("measured/") + GetParam().data);
  const Json result = ResultOf(GetParam().recording, GetParam().data, GetParam().without);
  for (std::size_t r = 0; r < result["ladder"].size(); ++r)
    EXPECT_THAT(NamesOn(result["ladder"][r]), ::testing::Each(::testing::AnyOfArray(GetParam().may))) << r;
}

std::string NameOf(const std::string& data) { return data.substr(0, data.find('_')); }

INSTANTIATE_TEST_SUITE_P(
    Six, RealRecording,
    ::testing::Values(
        Real{"emps_estimation.toml", "emps_estimation.csv", {"coulomb_friction"}, 2.0},
        Real{"cascaded_tanks.toml", "cascaded_tanks.csv", {"overflow"}, 0.30},
        Real{"silverbox_snls80mv.toml", "silverbox_snls80mv.csv", {"cubic_stiffness"}, 1.3e-3},
        Real{"afm_indentation_zebrafish.toml", "afm_indentation_zebrafish.csv", {"adhesion"}, 0.08e-9},
        Real{"brfd_friction_backlash.toml", "brfd_friction_backlash.csv", {"backlash", "presliding_friction"}, 1335.0},
        Real{"pneumatic_seal_friction.toml", "pneumatic_seal_friction.csv", {"pressure_dependent_friction"}, 1.5}),
    [](const auto& info) { return NameOf(info.param.data); });

INSTANTIATE_TEST_SUITE_P(
    Six, RealControl,
    ::testing::Values(
        Control{"emps_estimation.toml",
                "emps_estimation.csv",
                "coulomb_friction,asymmetric_friction",
                {"presliding_friction", "stribeck_friction", "hysteresis"}},
        Control{"cascaded_tanks.toml", "cascaded_tanks.csv", "overflow", {"linear_loss"}},
        Control{"silverbox_snls80mv.toml", "silverbox_snls80mv.csv", "cubic_stiffness", {"quadratic_stiffness"}},
        Control{"afm_indentation_zebrafish.toml",
                "afm_indentation_zebrafish.csv",
                "adhesion",
                {"stress_relaxation", "viscous_friction", "drag"}},
        Control{"brfd_friction_backlash.toml",
                "brfd_friction_backlash.csv",
                "backlash,presliding_friction,hysteresis",
                {"stribeck_friction", "asymmetric_friction"}},
        Control{"pneumatic_seal_friction.toml",
                "pneumatic_seal_friction.csv",
                "pressure_dependent_friction",
                {"presliding_friction", "asymmetric_friction", "stribeck_friction", "hysteresis"}}),
    [](const auto& info) { return NameOf(info.param.data); });

}  // namespace
}  // namespace armcmc::test::real_recordings_test
