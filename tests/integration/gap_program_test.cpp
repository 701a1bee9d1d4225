// armcmc-gap as a user runs it, on recordings of armcmc-plant.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "integration/files.hpp"
#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::gap_program_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Row = std::vector<std::string>;

std::vector<Row> Rows(const std::filesystem::path& path) {
  std::vector<Row> rows;
  std::istringstream text(Text(path));
  for (std::string line; std::getline(text, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

std::string Csv(const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) text += (i == 0 ? "" : ",") + row[i];
    text += '\n';
  }
  return text;
}

class GapProgram : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { shared_ = new ScratchDir(); }
  static void TearDownTestSuite() {
    delete shared_;
    shared_ = nullptr;
  }

  /// Four seconds of a plant that hides a bias (its truth beside it, in run.json), or of one that hides nothing
  /// (plain.csv). Made when first asked for.
  static std::string Data(const std::string& name = "run.csv") {
    std::string path = *shared_ / name;
    if (std::filesystem::exists(path)) return path;
    std::vector<std::string> arguments = {
        "--scenario", (SourceDir() / "plant_sim/scenarios/contact_rich.toml").string(),
        "--seed",     "5",
        "--duration", "4",
        "--csv",      path};
    if (name == "run.csv")
      arguments.insert(arguments.end(),
                       {"--hide-effect", "force_bias", "--effect-strength", "3", "--sealed", *shared_ / "run.json"});
    const Outcome o = RunProgram(Program("armcmc-plant"), arguments);
    EXPECT_EQ(o.code, 0) << o.err;
    return path;
  }
  [[nodiscard]] std::string Out() const { return dir_ / "out"; }
  /// The first sample rows of the run, changed; index 0 is the header.
  std::string Changed(const std::function<void(std::vector<Row>*)>& change, std::size_t rows = 4001) const {
    std::vector<Row> all = Rows(Data());
    all.resize(std::min(rows, all.size()));
    for (Row& row : all) row.resize(4);
    change(&all);
    std::ofstream(dir_ / "changed.csv") << Csv(all);
    return dir_ / "changed.csv";
  }
  [[nodiscard]] Outcome Gap(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--out", Out(), "--no-pairs"});
    return RunProgram(Program("armcmc-gap"), arguments);
  }
  [[nodiscard]] Json Result() const { return Json::Parse(Text(dir_ / "out/result.json")); }
  void ExpectRefused(const std::vector<std::string>& arguments, const std::vector<std::string>& words) const {
    const Outcome o = Gap(arguments);
    EXPECT_EQ(o.code, 2) << o.out << o.err;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_THAT(o.err, ::testing::StartsWith("armcmc-gap: "));
    for (const std::string& word : words) EXPECT_THAT(o.err, HasSubstr(word));
    for (const char* file : {"result.json", "report.html", "model.toml"})
      EXPECT_FALSE(std::filesystem::exists(dir_ / "out" / file)) << file;
  }

  ScratchDir dir_;
  static inline ScratchDir* shared_ = nullptr;
};

TEST_F(GapProgram, HelpTeaches) {
  const Outcome help = RunProgram(Program("armcmc-gap"), {"--help"});
  EXPECT_EQ(help.code, 0);
  for (const char* word : {"Example:", "--data", "--heldout", "--steps", "--skip-bad", "Exit status"})
    EXPECT_THAT(help.out, HasSubstr(word));
  EXPECT_EQ(RunProgram(Program("armcmc-gap"), {"--version"}).code, 0);
  const Outcome bare = RunProgram(Program("armcmc-gap"), {});
  EXPECT_EQ(bare.code, 2);
  EXPECT_THAT(bare.err, HasSubstr("--data"));
}

TEST_F(GapProgram, BadFilesAreRefusedInOneLineThatNamesThePlace) {
  ExpectRefused({"--data", dir_ / "missing.csv"}, {"missing.csv"});
  { const std::ofstream empty(dir_ / "empty.csv"); }
  ExpectRefused({"--data", dir_ / "empty.csv"}, {"empty.csv", "t,x,v,f"});
  ExpectRefused({"--data", Changed([](auto* rows) { rows->resize(1); })}, {"changed.csv"});
  ExpectRefused({"--data", Changed([](auto* rows) { rows->resize(2); })}, {"changed.csv", "1 samples"});
  ExpectRefused({"--data", Changed([](auto* rows) { (*rows)[500][3] = "nan"; })}, {"changed.csv:501", "f = nan"});
  ExpectRefused({"--data", Changed([](auto* rows) { std::swap((*rows)[500], (*rows)[501]); })},
                {"changed.csv:502", "time must increase"});
  ExpectRefused({"--data", Changed([](auto* rows) {
                   for (Row& row : *rows) row.resize(3);
                 })},
                {"changed.csv:1", "column f is missing"});
  ExpectRefused({"--data", Changed([](auto*) {}, 301)}, {"changed.csv", "samples; at least"});
}

TEST_F(GapProgram, BadUsageIsRefused) {
  ExpectRefused({"--data", Data(), "--steps", "find,guess"}, {"--steps", "'guess'", "compare, find, name, add, show"});
  ExpectRefused({"--data", Data(), "--model", "no_such_model"}, {"no_such_model", "hunt_crossley"});
  ExpectRefused({"--data", Data(), "--seed", "minus one"}, {"--seed"});
  ExpectRefused({"--data", Data(), "--without", "force_bais"}, {"--without", "force_bais", "force_bias"});
  ExpectRefused({"--data", Data(), "--model", "soft_actuator_excited", "--without", "force_bias"},
                {"--without", "leak", "joint_friction"});
  ExpectRefused({"--data", Data(), "--heldout", dir_ / "missing.csv"}, {"missing.csv"});
  std::ofstream(dir_ / "file") << "in the way";
  const Outcome o = RunProgram(Program("armcmc-gap"), {"--data", Data(), "--out", dir_ / "file/out"});
  EXPECT_EQ(o.code, 2) << o.err;
  EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  EXPECT_THAT(o.err, HasSubstr("--out"));
}

TEST_F(GapProgram, NamesWhatIsHiddenAndWritesEveryFile) {
  const Outcome o = Gap({"--data", Data()});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.err, IsEmpty());
  EXPECT_THAT(o.out, HasSubstr("Missing: force_bias"));
  const Json result = Result();
  EXPECT_EQ(result.at("schema"), 1);
  EXPECT_EQ(result.at("verdict"), "named");
  ASSERT_EQ(result.at("effects").size(), 1u);
  const Json effect = result["effects"][0];
  EXPECT_EQ(effect.at("name"), "force_bias");
  const double truth = Json::Parse(Text(*shared_ / "run.json"))["effects"][0]["parameters"]["force"]["value"];
  const double mean = effect.at("parameters").at("force").at("mean"), sd = effect["parameters"]["force"].at("sd");
  EXPECT_LT(std::abs(mean - truth), 4.0 * sd);
  EXPECT_GT(result.at("gap").at("closed_fraction").get<double>(), 0.95);
  EXPECT_LT(result["gap"].at("heldout_rmse_after").get<double>(),
            result["gap"].at("heldout_rmse_before").get<double>());
  EXPECT_NEAR(result["gap"]["after"]["coverage95"].get<double>(), 0.95, 0.02);
  EXPECT_TRUE(std::filesystem::exists(dir_ / "out/report.html"));
  EXPECT_THAT(Text(dir_ / "out/model.toml"), HasSubstr("name = \"force_bias\""));
  for (const auto& entry : std::filesystem::directory_iterator(Out()))
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}

TEST_F(GapProgram, StopsEarlyAndLeavesNothingOfAnOlderRun) {
  ASSERT_EQ(Gap({"--data", Data()}).code, 0);
  std::ofstream(dir_ / "out/experiment.toml") << "of an older run";
  std::ofstream(dir_ / "out/notes.txt") << "of the user";
  const Outcome o = Gap({"--data", Data(), "--steps", "find,name"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(Result().at("verdict"), "named");
  EXPECT_FALSE(Result().at("where").empty());
  EXPECT_EQ(Result().at("model_file"), "");
  for (const char* file : {"report.html", "model.toml", "experiment.toml"})
    EXPECT_FALSE(std::filesystem::exists(dir_ / "out" / file)) << file;
  EXPECT_EQ(Text(dir_ / "out/notes.txt"), "of the user");
  EXPECT_THAT(o.out, Not(HasSubstr("report:")));
  // A run that finds nothing takes the model of one that did away, too.
  std::ofstream(dir_ / "out/model.toml") << "of an older run";
  ASSERT_EQ(Gap({"--data", Data("plain.csv")}).code, 0);
  EXPECT_EQ(Result().at("verdict"), "none");
  EXPECT_FALSE(std::filesystem::exists(dir_ / "out/model.toml"));
  // And so does one that fails after its data were read.
  std::ofstream(dir_ / "out/model.toml") << "of an older run";
  ExpectRefused({"--data", Changed([](auto* rows) {
                   for (std::size_t i = 1; i < rows->size(); ++i) (*rows)[i][1] = "0.1";
                 })},
                {"changed.csv", "does not move"});
}

TEST_F(GapProgram, TheSameSeedGivesTheSameBytes) {
  const auto run = [this](const std::string& seed) {
    EXPECT_EQ(Gap({"--data", Data(), "--seed", seed}).code, 0);
    return std::pair{Result().Without({"seconds", "budget"}).dump(), Text(dir_ / "out/model.toml")};
  };
  const auto first = run("3"), second = run("3"), other = run("4");
  EXPECT_EQ(first.first, second.first);
  EXPECT_EQ(first.second, second.second);
  // Another seed draws another bootstrap and changes no fit.
  EXPECT_EQ(first.second, other.second);
  const Json a = Json::Parse(first.first), b = Json::Parse(other.first);
  EXPECT_EQ(a["verdict"], b["verdict"]);
  EXPECT_EQ(a["parameters"], b["parameters"]);
  EXPECT_EQ(a["effects"][0]["parameters"], b["effects"][0]["parameters"]);
  EXPECT_EQ(a["gap"]["heldout_rmse_after"], b["gap"]["heldout_rmse_after"]);
  EXPECT_NE(first.first, other.first);
}

TEST_F(GapProgram, BadRowsAreSkippedOnDemandAndCounted) {
  const std::string bad = Changed(
      [](auto* rows) {
        (*rows)[500][3] = "nan";
        (*rows)[900][3] = "x";
      },
      4001);
  const Outcome o = Gap({"--data", bad, "--skip-bad", "--steps", "name"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(Result()["effects"][0]["name"], "force_bias");
  EXPECT_THAT(Result()["notes"].dump(), HasSubstr("skipped"));
}

TEST_F(GapProgram, ShowsTheGapOnAnotherRun) {
  // The same plant with the same seed is the same run: the bias of another plant is another one.
  ASSERT_EQ(Gap({"--data", Data(), "--heldout", Data()}).code, 0);
  EXPECT_GT(Result()["gap"]["closed_fraction"].get<double>(), 0.95);
  ASSERT_EQ(Gap({"--data", Data(), "--heldout", Data("plain.csv")}).code, 0);
  EXPECT_LT(Result()["gap"]["closed_fraction"].get<double>(), 0.1) << "a plant that lacks nothing";
  ExpectRefused({"--data", Data(), "--heldout", Changed([](auto*) {}, 20)}, {"changed.csv", "19 samples"});
}

TEST_F(GapProgram, AVelocityThatIsMissingIsDerived) {
  const std::string derived = Changed(
      [](auto* rows) {
        for (Row& row : *rows) row.erase(row.begin() + 2);
      },
      4001);
  ASSERT_EQ(Gap({"--data", derived, "--steps", "name"}).code, 0);
  EXPECT_EQ(Result()["effects"][0]["name"], "force_bias");
  EXPECT_THAT(Result()["notes"].dump(), HasSubstr("column v is missing"));
}

TEST_F(GapProgram, AWrongUnitGivesNoFalseName) {
  for (const std::vector<std::size_t>& columns : {std::vector<std::size_t>{1}, {2}, {1, 2}, {3}}) {
    const std::string wrong = Changed(
        [&](auto* rows) {
          for (std::size_t i = 1; i < rows->size(); ++i)
            for (const std::size_t c : columns) (*rows)[i][c] = std::to_string(1e3 * std::stod((*rows)[i][c]));
        },
        4001);
    const Outcome o = Gap({"--data", wrong, "--steps", "name"});
    ASSERT_EQ(o.code, 0) << o.err;
    const Json result = Result();
    if (result["verdict"] == "named") {
      EXPECT_EQ(result["effects"][0]["name"], "force_bias") << o.out;
    }
  }
}

TEST_F(GapProgram, SamplesThatMakeNoPacksAreDiagnosedAllTheSame) {
  // 3 ms do not divide the 100 ms of a pack.
  const std::string sparse = Changed(
      [](auto* rows) {
        std::vector<Row> kept{rows->front()};
        for (std::size_t i = 1; i < rows->size(); i += 3) kept.push_back((*rows)[i]);
        *rows = kept;
      },
      4001);
  const Outcome o = Gap({"--data", sparse});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(Result()["effects"][0]["name"], "force_bias") << o.out;
  EXPECT_EQ(Result()["budget"]["measured"], false);
  EXPECT_THAT(Result()["notes"].dump(), HasSubstr("--period-ms"));
}

/// Root mean square of column `value` less column `reference` over the rows of a CSV file.
double Error(const std::filesystem::path& path, const std::string& value, const std::string& reference,
             std::size_t first_row) {
  const Table table = ReadTable(path);
  const std::vector<std::string>&values = table.at(value), &references = table.at(reference);
  double sum = 0.0, count = 0.0;
  for (std::size_t i = first_row; i < values.size(); ++i) {
    if (values[i].empty() || references[i].empty()) continue;
    const double error = std::stod(values[i]) - std::stod(references[i]);
    sum += error * error;
    count += 1.0;
  }
  EXPECT_GT(count, 1000.0);
  return std::sqrt(sum / count);
}

TEST_F(GapProgram, TheModelRunsInReplayAndErrsLess) {
  ASSERT_EQ(Gap({"--data", Data()}).code, 0);
  const auto replay = [this](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"--config",      (SourceDir() / "rt/config/hunt_crossley.toml").string(),
                                          "--data",        Data(),
                                          "--out",         dir_ / (name + ".csv"),
                                          "--predictions", dir_ / (name + "_pred.csv")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome o = RunProgram(Program("armcmc-replay"), arguments);
    EXPECT_EQ(o.code, 0) << o.err;
  };
  replay("before", {});
  replay("after", {"--model", dir_ / "out/model.toml"});
  EXPECT_THAT(Rows(dir_ / "after.csv")[0], ::testing::Contains("force_bias_force"));
  const double before = Error(dir_ / "before_pred.csv", "y_shown", "y", 1000);
  const double after = Error(dir_ / "after_pred.csv", "y_shown", "y", 1000);
  EXPECT_LT(after, 0.8 * before);
}

}  // namespace
}  // namespace armcmc::test::gap_program_test
