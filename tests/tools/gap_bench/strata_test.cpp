#include "armcmc/gap_bench/strata.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <armcmc/support/csv.hpp>
#include <armcmc/support/program.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>

#include "support/paths.hpp"

namespace armcmc::gap_bench::strata_test {
namespace {

/// Files with the columns of the recordings that the stratum needs, a few seconds long.
void WriteRecordings(const std::filesystem::path& folder) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"emps_estimation.csv", "t_s,q_meas_m"},
      {"brfd_friction_backlash.csv", "t_s,disp_in"},
      {"pneumatic_seal_friction.csv", "t_ms,position_mm"},
      {"afm_indentation_zebrafish.csv", "t_s,height_m,deflection_m,force_N"}};
  for (const auto& [name, header] : files) {
    std::ofstream file(folder / name);
    file << header << '\n';
    const double unit = header.starts_with("t_ms") ? 1000.0 : 1.0;
    for (int i = 0; i < 4000; ++i) {
      file << unit * 1e-3 * i;
      for (const char c : header)
        if (c == ',') file << ',' << std::sin(2e-3 * i);
      file << '\n';
    }
  }
}

TEST(Strata, LargerRunsRepeatTheCasesOfSmallerOnes) {
  const test::ScratchDir folder;
  const test::ScratchDir recordings;
  WriteRecordings(recordings.path());
  for (const std::string& stratum : StratumNames()) {
    std::set<std::string> small, large;
    for (const Case& one : CasesOf(stratum, 1, 5, folder.path(), recordings.path())) small.insert(one.Name());
    const std::vector<Case> more = CasesOf(stratum, 3, 5, folder.path(), recordings.path());
    for (const Case& one : more) large.insert(one.Name());
    EXPECT_EQ(large.size(), more.size()) << stratum << ": two cases of one name";
    EXPECT_EQ(large.size(), 3 * small.size()) << stratum;
    for (const std::string& name : small) EXPECT_TRUE(large.contains(name)) << name;
  }
}

TEST(Strata, AnotherSeedMakesOtherCases) {
  const test::ScratchDir folder;
  EXPECT_NE(CasesOf("singles", 1, 5, folder.path()).front().seed, CasesOf("singles", 1, 6, folder.path()).front().seed);
}

TEST(Strata, RealMotionAndNoiseAreWrittenInUnitsOfTheDepthAndEveryRecordingIsJudgedByItsHalves) {
  const test::ScratchDir folder, recordings;
  WriteRecordings(recordings.path());
  const std::vector<Case> cases = CasesOf(kRecorded, 1, 5, folder.path(), recordings.path());
  std::map<std::uint64_t, int> parts;
  for (const Case& one : cases) {
    ++parts[one.seed];
    EXPECT_TRUE(std::filesystem::exists(folder.path() / one.scenario)) << one.scenario;
  }
  for (const auto& [seed, count] : parts) EXPECT_TRUE(count == 1 || count == 3) << seed;
  support::CsvRequest request;
  request.columns = {"t", "x"};
  const support::CsvSamples motion = support::ReadCsv(folder.path() / "scenarios" / "servo_axis.csv", request);
  const auto [low, high] = std::minmax_element(motion.columns[1].begin(), motion.columns[1].end());
  EXPECT_NEAR(*low, -0.25, 1e-12);
  EXPECT_NEAR(*high, 1.0, 1e-12);
  EXPECT_NEAR(motion.columns[0].back(), 3.999, 2e-3);
}

TEST(Strata, RealRecordingsHaveToBeThere) {
  const test::ScratchDir folder;
  EXPECT_THROW(static_cast<void>(CasesOf(kRecorded, 1, 5, folder.path())), support::InputError);
  EXPECT_THROW(static_cast<void>(CasesOf(kRecorded, 1, 5, folder.path(), folder.path())), support::InputError);
}

TEST(Strata, AnUnknownStratumIsAnError) {
  EXPECT_THROW(static_cast<void>(CasesOf("gremlins", 1, 1, "")), std::invalid_argument);
}

}  // namespace
}  // namespace armcmc::gap_bench::strata_test
