// armcmc-gap on plants that a file describes: what a user types, and what is in the folder then.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "armcmc/support/sha256.hpp"
#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::ladder_program_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kScenario = R"(schema = 1
rate_hz = 100
duration_s = 20
seed = 11
[truth]
M = 100.0
Fv = 180.0
off = 2.0
[inputs]
q = { kind = "multisine", amplitude = 0.08, bandwidth_hz = 1.5 }
[noise]
law = "gaussian"
std = 2.0
)";

constexpr const char* kRecording = R"(
schema = 1
model = "servo_axis"
file = "run.csv"
title = "servo"
[columns]
t = { column = "t" }
q = { column = "q" }
v = { column = "v" }
a = { column = "a" }
F = { column = "F" }
[held_out]
rows = [[300, 600], [1500, 2000]]
)";

class LadderProgram : public ::testing::Test {
 protected:
  std::filesystem::path Simulate(const std::string& hidden) const {
    std::ofstream(dir_ / "scenario.toml") << kScenario << hidden;
    const Outcome run = RunProgram(Program("armcmc-plant"), {"--model", "servo_axis", "--scenario",
                                                             dir_ / "scenario.toml", "--csv", dir_ / "run.csv"});
    EXPECT_EQ(run.code, 0) << run.err;
    return dir_ / "run.csv";
  }
  [[nodiscard]] Outcome Gap(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all{"--out", dir_ / "out"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return RunProgram(Program("armcmc-gap"), all);
  }
  [[nodiscard]] Json Result() const { return ReadJson(dir_ / "out" / "result.json"); }
  ScratchDir dir_;
};

constexpr const char* kFriction = "[[hidden]]\nslot = \"output\"\nvalue = \"14*tanh(v/0.004)\"\n";

TEST_F(LadderProgram, NamesWhatIsHiddenAndWritesAModelThatLacksNothing) {
  const std::filesystem::path csv = Simulate(kFriction);
  std::ofstream(dir_ / "recording.toml") << kRecording;
  const Outcome run = Gap({"--recording", dir_ / "recording.toml"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("+ coulomb_friction"));
  EXPECT_THAT(run.out,
              testing::ContainsRegex("held-out segment +before +after +samples\n[0-9.]+ to 5\\.9[0-9]* s +[0-9.]+ "));
  const Json result = Result();
  EXPECT_EQ(result["verdict"], "named");
  EXPECT_EQ(result["schema"], 1);
  ASSERT_EQ(result["ladder"].size(), 1u);
  ASSERT_EQ(result["ladder"][0]["effects"].size(), 1u);
  EXPECT_EQ(result["ladder"][0]["effects"][0], "coulomb_friction");
  EXPECT_GT(result["ladder"][0]["closed_fraction"].number(), 0.95);
  EXPECT_GT(result["ladder"][0]["probability"].number(), 0.95);
  double sum = result["probability"]["none"].number() + result["probability"]["unnamed"].number();
  for (const Json& candidate : result["candidates"]) sum += candidate["probability"].number();
  EXPECT_NEAR(sum, 1.0, 1e-9) << "an explanation is counted once";
  EXPECT_EQ(result["complete"], true);
  EXPECT_EQ(result["effects"][0]["name"], "coulomb_friction");
  EXPECT_EQ(result["effects"][0]["family"], "dry friction");
  EXPECT_NEAR(result["effects"][0]["parameters"]["Fc"]["mean"].get<double>(), 14.0, 1.0);
  EXPECT_EQ(result["effects"][0]["parameters"]["Fc"]["unit"], "N");
  // The friction that the model lacked was taken for viscosity.
  EXPECT_GT(result["parameters"]["before"]["Fv"]["mean"].get<double>(), 195.0);
  EXPECT_NEAR(result["parameters"]["after"]["Fv"]["mean"].get<double>(), 180.0, 6.0);
  EXPECT_NEAR(result["gap"]["heldout_rmse_after"].get<double>(), 2.0, 0.25);
  ASSERT_EQ(result["gap"]["stretches"].size(), 2u);
  EXPECT_NEAR(result["gap"]["stretches"][0]["until_s"].get<double>(), 5.99, 0.01);
  EXPECT_GT(result["gap"]["stretches"][1]["rmse_before"].get<double>(), 3.0);
  EXPECT_NEAR(result["gap"]["stretches"][1]["rmse_after"].get<double>(), 2.0, 0.25);
  const double closed = result["gap"]["closed_fraction"].number();
  EXPECT_LT(result["gap"]["closed_fraction_95"][0].number(), closed);
  EXPECT_GT(result["gap"]["closed_fraction_95"][1].number(), closed);
  EXPECT_EQ(result["data"]["sha256"], support::Sha256OfFile(csv));
  EXPECT_EQ(result["budget"]["measured"], true);
  // One pack ahead, too, and its intervals hold what they promise; the mass stays.
  EXPECT_GT(result["one_step"]["before"]["rmse"].get<double>(), 3.0);
  EXPECT_NEAR(result["one_step"]["after"]["rmse"].get<double>(), 2.0, 0.15);
  EXPECT_NEAR(result["one_step"]["after"]["coverage95"].get<double>(), 0.95, 0.03);
  EXPECT_GT(result["one_step"]["after"]["kept_apart"]["samples"].get<double>(), 500.0);
  EXPECT_EQ(result["drift"]["M"]["after"]["constant"], true);
  EXPECT_TRUE(result["drift"]["coulomb_friction_Fc"]["before"].is_null());
  EXPECT_NEAR(result["drift"]["coulomb_friction_Fc"]["after"]["mean"].get<double>(), 14.0, 1.0);
  for (const char* key : {"ambiguous_set", "separate_by", "candidates", "where", "budget", "remainder", "published"})
    EXPECT_TRUE(result.contains(key)) << key;
  for (const char* file : {"report.html", "model.toml"})
    EXPECT_TRUE(std::filesystem::exists(dir_ / "out" / file)) << file;

  const std::filesystem::path model = dir_ / "found.toml";
  std::filesystem::copy_file(dir_ / "out" / "model.toml", model);
  const Outcome check = RunProgram(Program("armcmc-model"), {"check", model});
  EXPECT_EQ(check.code, 0) << check.err;
  const Outcome again = Gap({"--model", model, "--data", csv});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(Result()["verdict"], "none");
  EXPECT_FALSE(std::filesystem::exists(dir_ / "out" / "model.toml"));
}

TEST_F(LadderProgram, AnEffectThatIsLeftOutByAnyOfItsNamesIsNotTried) {
  const std::filesystem::path csv = Simulate(kFriction);
  for (const char* name : {"coulomb_friction", "joint_friction"}) {
    const Outcome run = Gap({"--model", "servo_axis", "--data", csv, "--without", name});
    ASSERT_EQ(run.code, 0) << run.err;
    const Json result = Result();
    for (std::size_t c = 0; c < result["candidates"].size(); ++c)
      EXPECT_NE(result["candidates"][c]["effects"][0].text(), "coulomb_friction");
    // Its family can be named still.
    for (std::size_t e = 0; e < result["effects"].size(); ++e)
      EXPECT_EQ(result["effects"][e]["family"], "dry friction");
  }
}

TEST_F(LadderProgram, WhatShowsInTheRowsKeptApartAloneIsNotNothing) {
  const std::filesystem::path csv = Simulate("[[hidden]]\nslot = \"output\"\nvalue = \"if(t > 15, 10, 0)\"\n");
  const Outcome run = Gap({"--model", "servo_axis", "--data", csv});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(Result()["verdict"], "unnamed");
  EXPECT_EQ(Result()["complete"], false);
  EXPECT_THAT(run.out, HasSubstr("they show something that the others do not"));
}

TEST_F(LadderProgram, SaysWhatIsWrongWithAnOrder) {
  const std::filesystem::path csv = Simulate("");
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& words) {
    const Outcome run = Gap(arguments);
    EXPECT_EQ(run.code, 2) << words;
    EXPECT_THAT(run.err, HasSubstr(words));
  };
  refused({"--model", "servo_axis"}, "--data CSV or --recording FILE");
  refused({"--recording", "axis.toml", "--model", "servo_axis"}, "--model excludes --recording");
  refused({"--recording", "axis.toml", "--skip-bad"}, "excludes");
  refused({"--model", "servo_axis", "--data", csv, "--without", "coulomb"},
          "--without: no effect is called \"coulomb\"");
  refused({"--model", "servo_axis", "--data", csv, "--heldout", csv}, "--heldout");
  refused({"--model", "servo_axis", "--data", csv, "--steps", "compare"}, "--steps");
  refused({"--model", "servo_axes", "--data", csv}, "servo_axes");
  std::ofstream(dir_ / "few.csv") << "t,q,v,a,F\n0,0,0,0,0\n0.01,0,0,0,1\n";
  refused({"--model", "servo_axis", "--data", dir_ / "few.csv"}, "few.csv");
}

TEST_F(LadderProgram, AGalleryLinksTheReportsOfAFolder) {
  const Outcome empty = RunProgram(Program("armcmc-gap"), {"--gallery", dir_.path()});
  EXPECT_EQ(empty.code, 2);
  EXPECT_THAT(empty.err, HasSubstr("no folder in it holds result.json"));
  ASSERT_EQ(Gap({"--model", "servo_axis", "--data", Simulate("")}).code, 0);
  const Outcome run = RunProgram(Program("armcmc-gap"), {"--gallery", dir_.path()});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, "gallery: " + (dir_ / "index.html").string() + "\n");
  std::ifstream file(dir_ / "index.html");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(page, HasSubstr("href=\"out/report.html\""));
  EXPECT_THAT(page, HasSubstr("nothing is missing"));
  std::ofstream(dir_ / "out" / "result.json") << "{}";
  const Outcome broken = RunProgram(Program("armcmc-gap"), {"--gallery", dir_.path()});
  EXPECT_EQ(broken.code, 2);
  EXPECT_THAT(broken.err, HasSubstr("out/result.json: is not a result of armcmc-gap"));
}

}  // namespace
}  // namespace armcmc::test::ladder_program_test
