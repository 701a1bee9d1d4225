#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/file_text.hpp"
#include "tools/replay_data.hpp"

namespace armcmc::replay::replay_program_test {
namespace {

using test::Outcome;
using ::testing::HasSubstr;

class ReplayProgram : public ::testing::Test {
 protected:
  ReplayProgram() {
    std::ofstream(dir_ / "contact.csv") << ContactCsv(301);
    std::ofstream(dir_ / "own.toml") << "schema = 1\n[model]\nname = \"hunt_crossley\"\n[sampler]\ndraws = 500\n"
                                        "[timing]\nperiod_ms = 100\n[rt]\nmode = \"enforce\"\n";
  }
  std::vector<std::string> Good() {
    return {"--config", dir_ / "own.toml", "--data", dir_ / "contact.csv", "--out", dir_ / "out.csv"};
  }
  static Outcome Run(const std::vector<std::string>& arguments) {
    return test::RunProgram(test::Program("armcmc-replay"), arguments);
  }
  static void ExpectBadInput(const std::vector<std::string>& arguments, const std::string& words) {
    const Outcome o = Run(arguments);
    EXPECT_EQ(o.code, 2) << o.err;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_THAT(o.err, HasSubstr(words));
  }
  std::string Text(const std::string& name) { return test::TextOf(dir_ / name); }
  test::ScratchDir dir_;
};

TEST_F(ReplayProgram, WritesEstimatesPredictionsAndReportAndSaysWhatItDid) {
  auto arguments = Good();
  arguments.insert(arguments.end(),
                   {"--predictions", dir_ / "pred.csv", "--report", dir_ / "report.json", "--seed", "5"});
  const Outcome o = Run(arguments);
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(o.err, "");
  EXPECT_THAT(o.out, HasSubstr("3 packs (0.3 s)"));
  EXPECT_THAT(o.out, HasSubstr("times real time"));
  const std::string csv = Text("out.csv"), predictions = Text("pred.csv"), report = Text("report.json");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);
  EXPECT_EQ(std::count(predictions.begin(), predictions.end(), '\n'), 301);
  EXPECT_THAT(report, HasSubstr("\"schema\": 1"));
  EXPECT_THAT(report, HasSubstr("\"seed\": 5"));
}

TEST_F(ReplayProgram, AModelFileAddsItsEffectsToTheEstimates) {
  std::ofstream(dir_ / "model.toml")
      << "schema = 1\nbase = \"hunt_crossley\"\n[[effect]]\nname = \"coulomb_friction\"\n"
         "speed = 0.05\nforce = { mean = 0.1, sd = 0.2 }\n";
  auto arguments = Good();
  arguments.insert(arguments.end(), {"--model", dir_ / "model.toml"});
  const Outcome o = Run(arguments);
  ASSERT_EQ(o.code, 0) << o.err;
  const std::string csv = Text("out.csv");
  EXPECT_THAT(csv.substr(0, csv.find('\n')), HasSubstr(",coulomb_friction_force,coulomb_friction_force_ap,"));
  std::ofstream(dir_ / "model.toml") << "schema = 1\nbase = \"hunt_crossley\"\n[[effect]]\nname = \"stiction\"\n";
  ExpectBadInput(arguments, "model.toml:4");
}

TEST_F(ReplayProgram, ADamagedLogIsReadAsFarAsItGoesAndTheLossIsSaid) {
  {
    LogWriter log(dir_ / "run.lcm");
    for (int k = 1; k <= 6; ++k) log.Write("PLANT_PACK", ContactPack(k));
  }
  std::string bytes = Text("run.lcm");
  const std::size_t event = bytes.size() / 6;
  bytes[2 * event + 2] = 0;                  // sync word of the third pack
  bytes = bytes.substr(0, 5 * event + 100);  // the sixth is cut
  std::ofstream(dir_ / "run.lcm", std::ios::binary) << bytes;
  const Outcome o = Run({"--config", dir_ / "own.toml", "--data", dir_ / "run.lcm", "--out", dir_ / "out.csv",
                         "--report", dir_ / "report.json"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("4 packs"));
  EXPECT_THAT(o.out, HasSubstr("lost 1,"));
  EXPECT_THAT(o.out, HasSubstr("the log is damaged: 1 place skipped (" + std::to_string(event + 100) +
                               " bytes), 1 event missing, cut off at its end"));
  EXPECT_THAT(Text("report.json"), HasSubstr("\"bytes_skipped\": " + std::to_string(event + 100)));
}

TEST_F(ReplayProgram, FindsTheConfigurationThatCameWithItByName) {
  auto arguments = Good();
  arguments[1] = "hunt_crossley";
  const Outcome o = Run(arguments);
  EXPECT_EQ(o.code, 0) << o.err;
}

TEST_F(ReplayProgram, BadInputIsOneLineThatNamesThePlace) {
  ExpectBadInput({}, "--config");
  auto arguments = Good();
  arguments[1] = dir_ / "none.toml";
  ExpectBadInput(arguments, "none.toml");
  arguments = Good();
  arguments[3] = dir_ / "none.csv";
  ExpectBadInput(arguments, "none.csv");
  arguments = Good();
  arguments[5] = dir_ / "no/such/folder/out.csv";
  ExpectBadInput(arguments, "cannot be written");
  arguments = Good();
  arguments.insert(arguments.end(), {"--model", "banana"});
  ExpectBadInput(arguments, "banana");

  std::ofstream(dir_ / "typo.toml") << Text("own.toml") << "[sampler2]\n";
  arguments = Good();
  arguments[1] = dir_ / "typo.toml";
  ExpectBadInput(arguments, "typo.toml:10:1: sampler2: unknown key (did you mean sampler?)");

  std::ofstream(dir_ / "nan.csv") << "t,x,v,f\n0,0,0,0\n0.001,nan,0,0\n";
  arguments = Good();
  arguments[3] = dir_ / "nan.csv";
  ExpectBadInput(arguments, "nan.csv:3: x = nan");
}

}  // namespace
}  // namespace armcmc::replay::replay_program_test
