#include "armcmc/gap_bench/strata.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <armcmc/support/csv.hpp>
#include <armcmc/support/program.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

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

std::string TextOf(const test::ScratchDir& folder, const Case& one) {
  std::ifstream file(folder.path() / one.scenario);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(Strata, SayInWhichOfThemThePlantIsNotTheCatalogue) {
  for (const char* name :
       {"law_error", "actuator_law_error", "unlisted", "formulas", "strokes", "strong_pairs", "near_null"}) {
    EXPECT_TRUE(Imperfect(name)) << name;
    EXPECT_NE(std::find(StratumNames().begin(), StratumNames().end(), name), StratumNames().end()) << name;
  }
  for (const char* name : {"null", "singles", "variants", "outside", "ties", kRecorded}) EXPECT_FALSE(Imperfect(name));
}

TEST(Strata, LawsErrByOneThreeAndTenPercentUnderEveryEffect) {
  const test::ScratchDir folder;
  for (const auto& [stratum, effects] : {std::pair<std::string, std::size_t>{"law_error", 14 * 2},
                                         std::pair<std::string, std::size_t>{"actuator_law_error", 13}}) {
    std::map<std::string, std::size_t> count;
    for (const Case& one : CasesOf(stratum, 1, 5, folder.path())) {
      const std::string text = TextOf(folder, one);
      const std::size_t at = text.find("[law]\nerror = ");
      ASSERT_NE(at, std::string::npos) << one.scenario;
      ++count[text.substr(at + 14, text.find('\n', at + 14) - at - 14)];
      EXPECT_FALSE(one.effect.empty());
    }
    EXPECT_EQ(count, (std::map<std::string, std::size_t>{{"0.01", effects}, {"0.03", effects}, {"0.1", effects}}));
  }
}

TEST(Strata, WhatNobodyListedStandsBesideEveryEffectAtAThirdOfItsSize) {
  const test::ScratchDir folder;
  std::set<std::string> listed, others;
  for (const Case& one : CasesOf("unlisted", 2, 5, folder.path())) {
    const std::string text = TextOf(folder, one);
    const auto value = [&](const std::string& key, std::size_t from) {
      const std::size_t at = text.find(key, from) + key.size();
      return text.substr(at, text.find('\n', at) - at);
    };
    const std::size_t first = text.find("[[hidden_effect]]"), second = text.find("[[hidden_effect]]", first + 1);
    ASSERT_NE(second, std::string::npos);
    listed.insert(value("name = ", first));
    others.insert(value("name = ", second));
    EXPECT_EQ(std::stod(value("strength = ", first)), one.strength);
    EXPECT_NEAR(std::stod(value("strength = ", second)), one.strength / 3.0, 1e-4);
    EXPECT_EQ(value("seed = ", first), std::to_string(one.seed));
  }
  EXPECT_EQ(listed.size(), 14u);
  EXPECT_EQ(others.size(), 5u);
}

TEST(Strata, FormulasPairsAndStrokesAreAsStrongAsTheySay) {
  const test::ScratchDir folder;
  const auto strengths = [&](const char* stratum) {
    std::map<double, int> count;
    for (const Case& one : CasesOf(stratum, 1, 5, folder.path())) ++count[one.strength];
    return count;
  };
  EXPECT_EQ(strengths("formulas"), (std::map<double, int>{{3.0, 10}, {10.0, 10}, {30.0, 10}}));
  EXPECT_EQ(strengths("strokes"), (std::map<double, int>{{3.0, 14}, {10.0, 14}}));
  EXPECT_EQ(strengths("strong_pairs"), (std::map<double, int>{{10.0, 10}}));
  for (const Case& one : CasesOf("strokes", 1, 5, folder.path())) EXPECT_EQ(one.scenario, "contact_strokes");
}

TEST(Strata, NearTheNullNothingIsHiddenAndOneConstantOrTheLawIsOff) {
  const test::ScratchDir folder;
  std::set<std::string> constants;
  int laws = 0;
  for (const Case& one : CasesOf("near_null", 1, 5, folder.path())) {
    EXPECT_EQ(one.effect, "none");
    const std::string text = TextOf(folder, one);
    if (text.find("[law]") != std::string::npos) {
      ++laws;
      continue;
    }
    for (const auto& [key, nominal] :
         std::map<std::string, double>{{"p_supply = ", 8e5}, {"q1 = ", 0.0704}, {"q3 = ", 3319.4}}) {
      const double off = std::stod(text.substr(text.find("\n" + key) + key.size() + 1)) / nominal - 1.0;
      if (std::abs(off) > 1e-9) constants.insert(key + std::to_string(off));
    }
  }
  EXPECT_EQ(laws, 9);
  EXPECT_EQ(constants, (std::set<std::string>{"p_supply = 0.001000", "p_supply = 0.010000", "q1 = 0.001000",
                                              "q1 = 0.010000", "q3 = 0.001000", "q3 = 0.010000"}));
}

TEST(Strata, AnUnknownStratumIsAnError) {
  EXPECT_THROW(static_cast<void>(CasesOf("gremlins", 1, 1, "")), std::invalid_argument);
}

}  // namespace
}  // namespace armcmc::gap_bench::strata_test
