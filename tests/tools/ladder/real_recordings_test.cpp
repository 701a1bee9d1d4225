// Recordings of real plants, whose data stay outside: the documented effect is named first and the error shrinks.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::real_recordings_test {
namespace {

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
  const std::filesystem::path file = SourceDir() / "tools" / "gap" / "recordings" / GetParam().recording;
  const ScratchDir dir;
  const Outcome run =
      RunProgram(Program("armcmc-gap"),
                 {"--recording", file, "--data-dir",
                  FindData(std::string("measured/") + GetParam().data)->parent_path(), "--out", dir / "out"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json result = ReadJson(dir / "out" / "result.json");
  ASSERT_FALSE(result["ladder"].empty()) << run.out;
  bool found = false;
  const Json names = result["ladder"][0]["effects"];
  for (std::size_t n = 0; n < names.size(); ++n)
    for (const std::string& wanted : GetParam().first) found = found || names[n].text() == wanted;
  EXPECT_TRUE(found) << run.out;
  EXPECT_LT(result["gap"]["heldout_rmse_after"].get<double>(), GetParam().error);
}

INSTANTIATE_TEST_SUITE_P(
    Six, RealRecording,
    ::testing::Values(
        Real{"emps_estimation.toml", "emps_estimation.csv", {"coulomb_friction"}, 2.0},
        Real{"cascaded_tanks.toml", "cascaded_tanks.csv", {"overflow"}, 0.30},
        Real{"silverbox_snls80mv.toml", "silverbox_snls80mv.csv", {"cubic_stiffness"}, 1.3e-3},
        Real{"afm_indentation_zebrafish.toml", "afm_indentation_zebrafish.csv", {"adhesion"}, 0.08e-9},
        Real{"brfd_friction_backlash.toml", "brfd_friction_backlash.csv", {"backlash", "presliding_friction"}, 1335.0},
        Real{"pneumatic_seal_friction.toml", "pneumatic_seal_friction.csv", {"pressure_dependent_friction"}, 1.5}),
    [](const auto& info) {
      const std::string name = info.param.data;
      return name.substr(0, name.find('_'));
    });

}  // namespace
}  // namespace armcmc::test::real_recordings_test
