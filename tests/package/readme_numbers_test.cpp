// Every number of the README: computed here, or the same as in the page that a command writes or a README links.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/csv_rows.hpp"

namespace armcmc::test::readme_numbers_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string TextOf(const std::filesystem::path& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file.is_open()) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string Page(const std::string& path) { return TextOf(SourceDir() / path); }

/// Cells of the rows of tables in Markdown that begin with a cell, without bold marks.
std::vector<std::vector<std::string>> Rows(const std::string& page, const std::string& first_cell) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("| ")) continue;
    std::vector<std::string> cells;
    std::istringstream rest(line.substr(1));
    for (std::string cell; std::getline(rest, cell, '|');)
      cells.push_back(std::regex_replace(cell, std::regex(R"(^[ *]+|[ *]+$)"), ""));
    if (cells.front() == first_cell) rows.push_back(cells);
  }
  return rows;
}

std::vector<std::string> Row(const std::string& page, const std::string& first_cell) {
  const auto rows = Rows(page, first_cell);
  EXPECT_FALSE(rows.empty()) << first_cell;
  return rows.empty() ? std::vector<std::string>(9) : rows.front();
}

double Number(const std::string& text) {
  double value = std::nan("");
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::string Rounded(double value, int digits) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%#.*g", digits, value);
  std::string rounded(text.data());
  if (rounded.back() == '.') rounded.pop_back();
  return rounded;
}

// The first run of tools/demo is this one, live; without misses its estimates are those of the replay.
TEST(ReadmeNumbers, TheTableOfTheDemoIsThatOfItsRun) {
  EXPECT_THAT(Page("tools/demo"), HasSubstr("seed=7 duration=20"));
  const ScratchDir dir;
  const Outcome plant = RunProgram(Program("armcmc-plant"), {"--scenario", "hunt_crossley_paper", "--seed", "7",
                                                             "--duration", "20", "--csv", dir / "run.csv"});
  ASSERT_EQ(plant.code, 0) << plant.err;
  const Outcome replay = RunProgram(Program("armcmc-replay"), {"--config", "hunt_crossley", "--data", dir / "run.csv",
                                                               "--out", dir / "estimates.csv"});
  ASSERT_EQ(replay.code, 0) << replay.err;
  const auto samples = RowsOf(TextOf(dir / "run.csv"));
  const auto estimates = RowsOf(TextOf(dir / "estimates.csv"));
  ASSERT_EQ(estimates.size(), 200U);
  const std::string readme = Page("README.md");
  for (const std::string name : {"K", "B", "p"}) {
    // As the plant scores: in contact, each sample with the estimate of the pack before the last; none counts as 0.
    double error = 0.0, error_known = 0.0, truth_known = 0.0, last = 0.0;
    int in_contact = 0, known = 0;
    for (std::size_t n = 1; n < samples.size(); ++n) {
      if (Number(samples[n].at("f_true")) == 0.0) continue;
      const double truth = Number(samples[n].at(name + "_true"));
      const std::size_t pack = (n - 1) / 100;
      const double shown = pack < 2 ? std::nan("") : Number(estimates[pack - 2].at(name));
      error += std::abs((std::isnan(shown) ? 0.0 : shown) - truth);
      ++in_contact;
      if (std::isnan(shown)) continue;
      error_known += std::abs(shown - truth);
      truth_known += truth;
      ++known;
      last = shown;
    }
    std::smatch row;
    const std::regex pattern(name + R"( +contact +([0-9.]+) +([0-9.]+) +([0-9.]+) % +([0-9.]+) % +([0-9.]+)\n)");
    ASSERT_TRUE(std::regex_search(readme, row, pattern)) << name;
    // Another order of the arithmetic draws another sample.
    EXPECT_NEAR(Number(row[1]) / (error / in_contact), 1.0, 0.05) << name;
    EXPECT_NEAR(Number(row[2]) / (error_known / known), 1.0, 0.05) << name;
    EXPECT_NEAR(Number(row[3]) / (100.0 * error_known / truth_known), 1.0, 0.05) << name;
    EXPECT_NEAR(Number(row[5]), last, 0.001) << name;
  }
}

TEST(ReadmeNumbers, AccuracyIsThatOfThePageOfTables) {
  const std::string readme = Page("README.md"), tables = Page("tools/tables/README.md");
  const std::map<std::string, std::string> names{{"ARMCMC", "AR-MAP"},
                                                 {"particle filter", "particle filter"},
                                                 {"random-walk MCMC", "MCMC-1"},
                                                 {"recursive least squares", "RLS"}};
  for (const auto& [here, there] : names) {
    const std::vector<std::string> short_row = Row(readme, here), row = Row(tables, there);
    ASSERT_GE(row.size(), 7U);
    // Paper, step and drift: parameters and force each.
    EXPECT_EQ(row[5], short_row[1] + " / " + short_row[2] + " / " + short_row[3]) << here;
    EXPECT_EQ(row[6], short_row[4]) << here;
  }
}

// The page is of a run of fewer seeds: the means of the parameters' errors over 5 and over 20 differ by up to a fifth,
// those of the force, which thousands of samples determine, by a tenth of that for ARMCMC and a tenth for the others.
TEST(ReadmeNumbers, AccuracyAgreesWithItsResults) {
  const std::string readme = Page("README.md"), results = Page("tools/tables/RESULTS.md");
  EXPECT_THAT(results, HasSubstr("$ armcmc-tables --seeds "));
  const std::size_t begin = results.find("\nContact: K, B and p drift from 2 s to 18 s:");
  ASSERT_NE(begin, std::string::npos);
  const std::string part = results.substr(begin, results.find("\n\n", begin) - begin);
  const std::map<std::string, std::string> names{{"ARMCMC", "AR-MAP"},
                                                 {"particle filter", "particle filter"},
                                                 {"random-walk MCMC", "MCMC-1"},
                                                 {"recursive least squares", "RLS"}};
  for (const auto& [here, there] : names) {
    const std::vector<std::string> cells = Row(readme, here);
    std::smatch row;
    const std::regex pattern("\n" + there + R"( {2,}([0-9.]+) +([0-9.]+) +([0-9.]+) +([0-9.]+) )");
    ASSERT_TRUE(std::regex_search(part, row, pattern)) << there;
    for (std::size_t i = 1; i <= 4; ++i)
      EXPECT_NEAR(Number(cells[i]) / Number(row[i]), 1.0,
                  i < 4              ? 0.2
                  : here == "ARMCMC" ? 0.02
                                     : 0.1)
          << here << ' ' << i;
  }
}

TEST(ReadmeNumbers, RecordingsAreThoseOfThePageOfTheWorkflow) {
  const std::string readme = Page("README.md"), page = Page("tools/gap/README.md");
  const std::map<std::string, std::string> names{{"EMPS servo axis", "EMPS servo axis"},
                                                 {"cascaded tanks", "cascaded tanks"},
                                                 {"Silverbox oscillator, arrow", "Silverbox oscillator, arrow"},
                                                 {"Silverbox oscillator, multisine", "the same, multisine"}};
  for (const auto& [here, there] : names) {
    const std::vector<std::string> short_row = Row(readme, here), row = Row(page, there);
    EXPECT_EQ(row[2], short_row[2]) << here;
    EXPECT_TRUE(row[3].ends_with(short_row[3])) << here << ": " << row[3];
  }
}

// tools/results writes this page and the next one. V and N, as printed, with one digit more than the README has.
TEST(ReadmeNumbers, RecordingsAreThoseOfTheirResults) {
  const std::string results = Page("tools/gap/recordings/RESULTS.md"), readme = Page("README.md");
  const auto errors = [&](const std::string& recording, const std::string& line) {
    const std::size_t begin = results.find("recordings/" + recording + ".toml");
    const std::string part = results.substr(begin, results.find("\n```\n", begin) - begin);
    std::smatch found;
    EXPECT_TRUE(std::regex_search(part, found, std::regex(line))) << recording << ": " << line;
    return std::pair(Number(found[1]), Number(found[2]));
  };
  const auto expect = [&](const std::string& row, const std::pair<double, double>& errors, double unit) {
    const std::vector<std::string> cells = Row(readme, row);
    EXPECT_NEAR(Number(cells[2]) / (unit * errors.first), 1.0, 0.006) << row;
    EXPECT_NEAR(Number(cells[3]) / (unit * errors.second), 1.0, 0.015) << row;
  };
  const std::string whole = R"(held-out rms error ([0-9.]+) -> ([0-9.]+) )";
  expect("EMPS servo axis", errors("emps_estimation", whole), 1.0);
  expect("cascaded tanks", errors("cascaded_tanks", whole), 1.0);
  expect("Silverbox oscillator, arrow", errors("silverbox_snls80mv", R"(0.3768 to 66.48 s +([0-9.]+) +([0-9.]+))"),
         1e3);
  expect("Silverbox oscillator, multisine", errors("silverbox_snls80mv", R"(173.2 to 208.7 s +([0-9.]+) +([0-9.]+))"),
         1e3);
}

TEST(ReadmeNumbers, SpeedIsThatOfTheBenchmarksPage) {
  const std::string results = Page("tools/bench/RESULTS.md");
  const std::vector<std::string> plants = {"hunt_crossley", "soft_actuator", "servo_axis", "pendulum", "two_tanks"};
  const std::vector<std::string> row = Row(Page("README.md"), "0.63 ms");
  ASSERT_GE(row.size(), plants.size());
  for (std::size_t i = 0; i < plants.size(); ++i) {
    std::smatch time;
    const std::regex pattern("BM_AdjustStep/" + plants[i] + R"(/14979/100/manual_time +([0-9.]+) ms)");
    ASSERT_TRUE(std::regex_search(results, time, pattern)) << plants[i];
    EXPECT_EQ(row[i], Rounded(Number(time[1]), 2) + " ms") << plants[i];
  }
}

/// All loads of one run of armcmc-stress.
struct StressRun {
  bool passed = false;
  int loads = 0;
  int steps = 0, outside = 0;               ///< `outside`: missed by the estimator itself, and not in a fault.
  double fastest_ms = 1e9, slowest_ms = 0;  ///< Release to estimate, medians.
};

StressRun StressRunOf(const std::string& page, const std::string& period) {
  const std::size_t begin = page.find(" --period-ms " + period + " ");
  EXPECT_NE(begin, std::string::npos) << period;
  const std::string part = begin == std::string::npos ? "" : page.substr(begin, page.find("\n```", begin) - begin);
  StressRun run;
  run.passed = part.find("verdict: passed") != std::string::npos;
  const std::regex load(
      R"(\n(none|cpu|memory|io|net|watchers) +[0-9.]+ +([0-9]+) +[0-9]+ +[0-9]+ +([0-9]+) +[0-9]+ +[0-9]+ +([0-9.]+) )");
  for (std::sregex_iterator it(part.begin(), part.end(), load), end; it != end; ++it, ++run.loads) {
    run.steps += static_cast<int>(Number((*it)[2]));
    run.outside += static_cast<int>(Number((*it)[3]));
    run.fastest_ms = std::min(run.fastest_ms, Number((*it)[4]));
    run.slowest_ms = std::max(run.slowest_ms, Number((*it)[4]));
  }
  return run;
}

TEST(ReadmeNumbers, DeadlinesAreThoseOfTheStressRuns) {
  const std::string readme = Page("README.md"), results = Page("tools/stress/RESULTS.md");
  for (const std::string period : {"100", "10"}) {
    const StressRun run = StressRunOf(results, period);
    EXPECT_TRUE(run.passed) << period;
    EXPECT_EQ(run.loads, 6) << period;
    const std::vector<std::string> row = Row(readme, period + " ms");
    EXPECT_EQ(std::regex_replace(row[1], std::regex(" "), ""), std::to_string(run.steps)) << period;
    EXPECT_EQ(row[2], std::to_string(run.outside)) << period;
    EXPECT_EQ(row[3], Rounded(run.fastest_ms, 2) + " to " + Rounded(run.slowest_ms, 2) + " ms") << period;
  }
  const StressRun fast = StressRunOf(results, "1");
  EXPECT_EQ(fast.loads, 1);
  const std::vector<std::string> row = Row(readme, "1 ms, with 1000 draws of 20 samples and without load or faults");
  EXPECT_EQ(std::regex_replace(row[1], std::regex(" "), ""), std::to_string(fast.steps));
  EXPECT_EQ(row[2], std::to_string(fast.outside) + (fast.passed ? "" : ": the run failed"));
  EXPECT_EQ(row[3], Rounded(fast.slowest_ms, 2) + " ms");
  // One fault a line of the catalogue.
  const std::string catalogue = Page("tools/stress/src/fault_catalog.cpp");
  const std::regex fault(R"(\n    \{"[a-z_]+", k)");
  EXPECT_EQ(std::distance(std::sregex_iterator(catalogue.begin(), catalogue.end(), fault), std::sregex_iterator()), 26);
  for (const char* page : {"README.md", "rt/README.md", "rt/deploy/stress.md"})
    EXPECT_THAT(Page(page), HasSubstr("26 ")) << page;
}

TEST(ReadmeNumbers, LimitsAreThoseOfTheCode) {
  const std::string types = Page("core/include/armcmc/types.hpp");
  EXPECT_THAT(types, AllOf(HasSubstr("kMaxPackInputs = 8;"), HasSubstr("kMaxParams = 8;"), HasSubstr("kMaxModes = 4;"),
                           HasSubstr("kMaxPackSamples = 256;"), HasSubstr("kMaxDraws = 150'000;")));
  EXPECT_THAT(Page("core/include/armcmc/plant/state_run.hpp"), HasSubstr("kMaxStates = 8;"));
  const auto effects = std::distance(std::filesystem::directory_iterator(SourceDir() / "core/effects"),
                                     std::filesystem::directory_iterator());
  EXPECT_THAT(Page("README.md"),
              AllOf(HasSubstr("- 8 signals besides the output, 8 sampled parameters in a mode, 4 modes, 8 states, 256 "
                              "samples in a pack, 150 000 draws."),
                    HasSubstr("a catalogue of " + std::to_string(effects) + ",")));
  // The default precision and reliability ask for so many draws.
  EXPECT_THAT(Page("rt/config/hunt_crossley.toml"), HasSubstr("14 979 draws per pack"));
}

// What the tests above rest on.
TEST(ReadmeNumbers, RowsAreReadWithoutTheirMarks) {
  EXPECT_THAT(Row("| a | b |\n|---|---|\n| **x** | 1 / 2 |\n", "x"), ElementsAre("x", "1 / 2"));
  EXPECT_EQ(Rounded(0.6274, 2), "0.63");
  EXPECT_EQ(Rounded(3.7, 2), "3.7");
  EXPECT_EQ(Rounded(12.4, 2), "12");
}

}  // namespace
}  // namespace armcmc::test::readme_numbers_test
