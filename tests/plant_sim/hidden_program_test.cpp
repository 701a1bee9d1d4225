// armcmc-plant as a process that hides effects.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "armcmc/support/sha256.hpp"
#include "files.hpp"
#include "plant_program.hpp"
#include "support/json.hpp"
#include "support/paths.hpp"

namespace armcmc::plant_sim::hidden_program_test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(PlantProgramHides, OnlyTheMeasuredForceDiffersFromAPlantWithoutTheEffect) {
  const test::ScratchDir folder;
  ASSERT_EQ(RunPlant({"--seed", "3", "--csv", "plain.csv"}, folder).code, 0);
  const test::Outcome ended = RunPlant({"--seed", "3", "--csv", "a.csv", "--hide-effect", "coulomb_friction:tanh",
                                        "--effect-gate", "from:8", "--sealed", "truth.json"},
                                       folder);
  ASSERT_EQ(ended.code, 0) << ended.err;
  std::ifstream plain(folder / "plain.csv"), hiding(folder / "a.csv");
  int line_number = 0, changed = 0;
  for (std::string a, b; std::getline(plain, a); ++line_number) {
    ASSERT_TRUE(std::getline(hiding, b));
    std::vector<std::string> x = Fields(a), y = Fields(b);
    ASSERT_EQ(x.size(), y.size());
    const bool same_force = x[3] == y[3];
    if (!same_force) ++changed;
    if (line_number <= 8000) {
      EXPECT_TRUE(same_force) << "before the gate: line " << line_number;
    }
    x[3] = y[3] = "";
    ASSERT_EQ(x, y) << "line " << line_number;
  }
  EXPECT_GT(changed, 11'000);
}

TEST(PlantProgramHides, NothingButTheSealedFileTellsWhat) {
  const test::ScratchDir folder;
  const test::Outcome ended = RunPlant({"--seed", "3", "--csv", "a.csv", "--log", "a.lcm", "--hide-effect",
                                        "coulomb_friction,sensor_delay", "--sealed", "truth.json"},
                                       folder);
  ASSERT_EQ(ended.code, 0) << ended.err;
  const std::string sealed = Text(folder / "truth.json");
  EXPECT_THAT(ended.out, HasSubstr(support::Sha256(sealed)));
  const test::Json truth = test::Json::Parse(sealed);
  EXPECT_EQ(truth.at("schema"), 1);
  EXPECT_EQ(truth.at("kind"), "pair");
  ASSERT_EQ(truth.at("effects").size(), 2u);
  EXPECT_EQ(truth["effects"][1].at("name"), "sensor_delay");
  EXPECT_EQ(truth["effects"][1].at("gate"), "always");
  EXPECT_EQ(truth["effects"][1].at("formula_kind"), "catalogue");
  EXPECT_NEAR(truth["effects"][1].at("gap_ratio").get<double>(), 1.0, 0.05);
  EXPECT_GT(truth["effects"][1].at("parameters").at("delay").at("value").get<double>(), 0.0);
  EXPECT_EQ(truth.at("base_parameters").at("K"), 4.0);
  for (const std::string& text : {ended.out, ended.err, Text(folder / "a.csv"), Text(folder / "a.lcm")})
    for (const char* word : {"coulomb", "friction", "delay", "pair", "always", "gap"})
      EXPECT_THAT(text, Not(HasSubstr(word)));
}

TEST(PlantProgramHides, ARandomDrawIsReproducedToTheByteAndNoneIsSealedToo) {
  const test::ScratchDir folder;
  // Seed 6 draws a pair.
  for (const std::string name : {"a", "b"})
    ASSERT_EQ(
        RunPlant({"--seed", "6", "--csv", name + ".csv", "--hide-effect", "random", "--sealed", name + ".json"}, folder)
            .code,
        0);
  EXPECT_EQ(Text(folder / "a.csv"), Text(folder / "b.csv"));
  EXPECT_EQ(Text(folder / "a.json"), Text(folder / "b.json"));
  ASSERT_EQ(RunPlant({"--seed", "6", "--csv", "plain.csv"}, folder).code, 0);
  ASSERT_EQ(
      RunPlant({"--seed", "6", "--csv", "none.csv", "--hide-effect", "none", "--sealed", "none.json"}, folder).code, 0);
  EXPECT_EQ(Text(folder / "none.csv"), Text(folder / "plain.csv"));
  EXPECT_EQ(test::Json::Parse(Text(folder / "none.json")).at("kind"), "none");
}

TEST(PlantProgramHides, TheSealedFileTellsAllThatAScorerNeeds) {
  const test::ScratchDir folder;
  const auto run = [&folder](const std::string& seed) {
    const test::Outcome ended =
        RunPlant({"--scenario", "contact_rich_mm", "--seed", seed, "--csv", seed + ".csv", "--sealed", seed + ".json",
                  "--hide-effect", "coulomb_friction:tanh", "--effect-gate", "from:4"},
                 folder);
    EXPECT_EQ(ended.code, 0) << ended.err;
    return test::Json::Parse(Text(folder / (seed + ".json")));
  };
  const test::Json truth = run("7"), other = run("8");
  const test::Json effect = truth.at("effects").at(0);
  EXPECT_EQ(effect.at("formula_kind"), "catalogue");
  EXPECT_EQ(effect.at("onset_s"), 4.0);
  EXPECT_TRUE(effect.at("end_s").is_null());
  EXPECT_NEAR(truth.at("gap_ratio").get<double>(), 1.0, 0.05);
  EXPECT_EQ(truth.at("motion").at("program"), "rich");
  EXPECT_EQ(truth.at("motion").at("depth"), 8e-3);
  const test::Json noise = truth.at("noise").at("f");
  EXPECT_EQ(noise.at("kind"), "gaussian");
  EXPECT_EQ(noise.at("unit"), "N");
  EXPECT_NEAR(noise.at("sd").get<double>(), 0.01 * noise.at("reference").get<double>(), 1e-12);
  EXPECT_LE(noise.at("correlation").get<double>(), 0.8);
  EXPECT_EQ(truth.at("noise").at("v").at("std"), 1e-4);
  for (const char* name : {"K", "B", "p"})
    EXPECT_NE(truth.at("base_parameters").at(name), other.at("base_parameters").at(name));
  EXPECT_NE(noise.at("correlation"), other.at("noise").at("f").at("correlation"));
  // The truth columns of the data say the same.
  std::ifstream csv(folder / "7.csv");
  std::string header, row;
  std::getline(csv, header);
  std::getline(csv, row);
  EXPECT_EQ(header, "t,x,v,f,f_true,K_true,B_true,p_true");
  EXPECT_EQ(std::stod(Fields(row).at(5)), truth.at("base_parameters").at("K").get<double>());
}

TEST(PlantProgram, ASeedGivesTheSameMotionToTheByteAndAnotherSeedAnother) {
  const test::ScratchDir folder;
  const auto run = [&folder](const std::string& seed, const std::string& name) {
    EXPECT_EQ(RunPlant({"--scenario", "contact_rich", "--seed", seed, "--csv", name}, folder).code, 0);
    return Text(folder / name);
  };
  const std::string a = run("1", "a.csv");
  EXPECT_EQ(a, run("1", "b.csv"));
  const std::string c = run("2", "c.csv");
  std::stringstream one(a), two(c);
  std::string x, y;
  double distance = 0.0;
  std::getline(one, x);
  std::getline(two, y);
  while (std::getline(one, x) && std::getline(two, y))
    distance += std::abs(std::stod(Fields(x).at(1)) - std::stod(Fields(y).at(1))) / 10'000;
  EXPECT_GT(distance, 0.02);
}

TEST(PlantProgram, AModelFileBecomesThePlant) {
  const test::ScratchDir folder;
  const auto run = [&folder](const std::string& text, const std::string& name) {
    std::ofstream(folder / "model.toml") << "schema = 1\nbase = \"hunt_crossley\"\n" << text;
    const test::Outcome ended =
        RunPlant({"--scenario", "contact_rich", "--model", "model.toml", "--csv", name}, folder);
    EXPECT_EQ(ended.code, 0) << ended.err;
    return Text(folder / name);
  };
  const std::string base = "[parameters.K]\nmean = 3.0\n";
  std::stringstream plain(run(base, "plain.csv")),
      biased(run(base + "[[effect]]\nname = \"force_bias\"\nforce = { mean = 0.5, sd = 0.1 }\n", "biased.csv"));
  std::string x, y;
  std::getline(plain, x);
  std::getline(biased, y);
  while (std::getline(plain, x) && std::getline(biased, y)) {
    const std::vector<std::string> a = Fields(x), b = Fields(y);
    ASSERT_EQ(std::stod(a.at(5)), 3.0);
    ASSERT_NEAR(std::stod(b.at(3)) - std::stod(a.at(3)), 0.5, 1e-12);
    ASSERT_EQ(a.at(4), b.at(4));  // f_true stays the base equation's
  }
}

TEST(PlantProgramHides, AScenarioFileMayNameTheEffect) {
  const test::ScratchDir folder;
  const std::string paper = Text(test::SourceDir() / "plant_sim/scenarios/hunt_crossley_paper.toml");
  const auto run = [&](const std::string& table) {
    std::ofstream(folder / "s.toml") << paper << "\n[[hidden_effect]]\n" << table;
    return RunPlant({"--scenario", "s.toml", "--csv", "a.csv", "--sealed", "truth.json"}, folder);
  };
  ASSERT_EQ(run("name = \"force_bias\"\ngate = \"until:5\"\n[hidden_effect.parameters]\nforce = -0.25\n").code, 0);
  const test::Json effect = test::Json::Parse(Text(folder / "truth.json")).at("effects").at(0);
  EXPECT_EQ(effect.at("parameters").at("force").at("value"), -0.25);
  EXPECT_EQ(effect.at("gate"), "until:5");
  const auto expect = [&](const std::string& table, const std::string& words) {
    const test::Outcome ended = run(table);
    EXPECT_EQ(ended.code, 2) << table;
    EXPECT_THAT(ended.err, HasSubstr(words));
  };
  expect("name = \"gremlin\"\n", "coulomb_friction");
  expect("name = \"inertia\"\nstrenght = 1.0\n", "strenght");
  expect("name = \"inertia\"\ngate = \"never\"\n", "until:S");
  expect("name = \"sensor_lag\"\nvariant = \"third_order\"\n", "second_order");
  expect("name = \"force_bias\"\n[hidden_effect.parameters]\nforze = 1.0\n", "forze");
  expect("name = \"force_bias\"\nstrength = 1.0\n[hidden_effect.parameters]\nforce = 1.0\n", "contradicts");
  expect("name = \"sensor_lag\"\n[hidden_effect.parameters]\ntau = 0.1\n", "variant");
}

TEST(PlantProgramHides, BadUsageEndsWithTwoAndOneClearLine) {
  const test::ScratchDir folder;
  const auto expect = [&folder](std::vector<std::string> arguments, const std::string& words) {
    arguments.insert(arguments.end(), {"--csv", "a.csv"});
    const test::Outcome ended = RunPlant(arguments, folder);
    EXPECT_EQ(ended.code, 2) << words;
    EXPECT_THAT(ended.err, HasSubstr(words));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  };
  expect({"--hide-effect", "inertia"}, "--sealed");
  expect({"--sealed", "t.json"}, "--hide-effect");
  expect({"--effect-gate", "free"}, "--hide-effect");
  expect({"--hide-effect", "gremlin", "--sealed", "t.json"}, "gremlin");
  expect({"--hide-effect", "inertia", "--sealed", "t.json", "--effect-gate", "late"}, "--effect-gate");
  expect({"--hide-effect", "inertia", "--sealed", "t.json", "--effect-strength", "0"}, "--effect-strength");
  expect({"--scenario", "soft_actuator_excited", "--hide-effect", "leak", "--effect-gate", "contact", "--sealed", "t"},
         "makes no contact");
  expect({"--model", "none.toml"}, "none.toml");
  expect({"--model", "none.toml", "--hide-effect", "inertia", "--sealed", "t"}, "contradicts --model");
  expect({"--scenario", "soft_actuator_paper", "--hide-effect", "leak", "--sealed", "t"}, "no noise");
}

}  // namespace
}  // namespace armcmc::plant_sim::hidden_program_test
