// armcmc-plant --model PLANT_FILE as a process, without a bus or on one inside of it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "armcmc/data_pack_v2_t.hpp"
#include "files.hpp"
#include "plant_program.hpp"
#include "support/paths.hpp"

namespace armcmc::plant_sim::described_program_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kScenario =
    "schema = 1\nrate_hz = 500\nduration_s = 1\n[truth]\nM = 100.0\n[inputs]\n"
    "q = { expression = \"0.1*sin(3*t)\" }\n[noise]\nlaw = \"none\"\n";

void Write(const std::filesystem::path& path, const std::string& text) { std::ofstream(path) << text; }

TEST(DescribedProgram, WritesWhatTheScenarioSays) {
  const test::ScratchDir folder;
  Write(folder / "s.toml", kScenario);
  const test::Outcome ended =
      RunPlant({"--model", "servo_axis", "--scenario", "s.toml", "--csv", "a.csv", "--log", "a.lcm"}, folder);
  ASSERT_EQ(ended.code, 0) << ended.err;
  const CsvTable table = ReadTable(folder / "a.csv");
  EXPECT_EQ(table.names, (std::vector<std::string>{"t", "q", "v", "a", "F"}));
  ASSERT_EQ(table.rows.size(), 500u);
  for (const std::vector<double>& row : table.rows) {
    EXPECT_NEAR(row[3], -0.9 * std::sin(3.0 * row[0]), 1e-14);
    EXPECT_NEAR(row[4], 100.0 * row[3] + 200.0 * row[2], 1e-11) << "Fv at its prior's mean";
  }
  lcm::LogFile log((folder / "a.lcm").string(), "r");
  int packs = 0;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    data_pack_v2_t pack{};
    ASSERT_EQ(pack.decode(event->data, 0, event->datalen), event->datalen);
    EXPECT_EQ(pack.seq, ++packs);
    EXPECT_EQ(pack.n_samples, 50);  // 0.1 s
    EXPECT_EQ(pack.y[49], table.rows[static_cast<std::size_t>(50 * packs - 1)][4]);
  }
  EXPECT_EQ(packs, 10);
}

TEST(DescribedProgram, SaysWhatItAssumesWithoutAScenario) {
  const test::ScratchDir folder;
  const auto run = [&folder](const std::string& seed, const std::string& csv) {
    return RunPlant({"--model", "pendulum", "--duration", "0.5", "--seed", seed, "--csv", csv}, folder);
  };
  const test::Outcome ended = run("1", "a.csv");
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("no scenario"));
  EXPECT_THAT(ended.err, HasSubstr("u 0 +- 1"));
  EXPECT_EQ(ReadTable(folder / "a.csv").rows.size(), 500u);
  ASSERT_EQ(run("1", "b.csv").code, 0);
  ASSERT_EQ(run("2", "c.csv").code, 0);
  EXPECT_EQ(Text(folder / "a.csv"), Text(folder / "b.csv"));
  EXPECT_NE(Text(folder / "a.csv"), Text(folder / "c.csv"));
}

TEST(DescribedProgram, EffectsThatADiagnosisShallLeaveOutAreNoMatter) {
  const test::ScratchDir folder;
  Write(folder / "p.toml",
        Text(test::SourceDir() / "core/plants/servo_axis/plant.toml") + "[effects]\nwithout = [\"cogging\"]\n");
  Write(folder / "s.toml", kScenario);
  const test::Outcome ended = RunPlant({"--model", "p.toml", "--scenario", "s.toml", "--csv", "a.csv"}, folder);
  EXPECT_EQ(ended.code, 0) << ended.err;
}

TEST(DescribedProgram, HidesEffects) {
  const test::ScratchDir folder;
  Write(folder / "s.toml", kScenario);
  Write(folder / "h.toml", std::string(kScenario) + "[[hidden]]\nslot = \"output\"\nvalue = \"25*tanh(v/0.01)\"\n");
  ASSERT_EQ(RunPlant({"--model", "servo_axis", "--scenario", "s.toml", "--csv", "a.csv"}, folder).code, 0);
  ASSERT_EQ(RunPlant({"--model", "servo_axis", "--scenario", "h.toml", "--csv", "b.csv"}, folder).code, 0);
  const CsvTable plain = ReadTable(folder / "a.csv"), hidden = ReadTable(folder / "b.csv");
  for (std::size_t n = 0; n < plain.rows.size(); ++n)
    EXPECT_NEAR(hidden.rows[n][4] - plain.rows[n][4], 25.0 * std::tanh(plain.rows[n][2] / 0.01), 1e-11);
}

TEST(DescribedProgram, PublishesPacksOfThePlant) {
  const test::ScratchDir folder;
  Write(folder / "s.toml", kScenario);
  const test::Outcome ended = RunPlant({"--model", "servo_axis", "--scenario", "s.toml", "--lcm-url", "memq://",
                                        "--speed", "1000", "--log", "a.lcm", "--csv", "a.csv"},
                                       folder);
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("10 of 10 packs sent"));
  EXPECT_THAT(Text(folder / "a.csv"), StartsWith("t,q,v,a,F\n0,"));
  lcm::LogFile log((folder / "a.lcm").string(), "r");
  const lcm::LogEvent* event = log.readNextEvent();
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->channel, "PLANT_PACK_V2");
}

TEST(DescribedProgram, WrongFilesEndWithTwoAndOneLineThatSaysWhere) {
  const test::ScratchDir folder;
  const std::string plant = Text(test::SourceDir() / "core/plants/servo_axis/plant.toml");
  const auto expect = [&folder](const std::string& plant_text, const std::string& scenario, const std::string& words) {
    Write(folder / "p.toml", plant_text);
    Write(folder / "s.toml", scenario);
    const test::Outcome ended = RunPlant({"--model", "p.toml", "--scenario", "s.toml", "--csv", "a.csv"}, folder);
    EXPECT_EQ(ended.code, 2) << words << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(words));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  };
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  expect(with(plant, "M*a", "M*aa"), kScenario, "p.toml:5:10");
  expect(with(plant, "Fv*v", "Fv*(v"), kScenario, "p.toml:5:");
  expect(plant + "[effects]\nuse = [\"offset\"]\n", kScenario, "[[hidden]]");
  expect(plant, with(kScenario, "M = 100.0", "m = 100.0"), "s.toml:5:");
  expect(plant, with(kScenario, "sin(3*t)", "sin(3*s)"), "s.toml:7:31");
  expect(plant, with(kScenario, "q = {", "v = {"), "s.toml:7:");
  expect(plant, with(kScenario, "[inputs]\nq = { expression = \"0.1*sin(3*t)\" }\n", ""), "inputs.q: is missing");
  expect(plant, with(kScenario, "rate_hz", "rate"), "rate");
  expect(plant, std::string(kScenario) + "[[hidden]]\nslot = \"rate:x\"\nvalue = \"1\"\n", "s.toml:11:");
  expect(plant, std::string(kScenario) + "[[hidden]]\nslot = \"inside\"\nvalue = \"1\"\n", "s.toml:11:");
  const auto usage = [&folder](std::vector<std::string> arguments, const std::string& words) {
    arguments.insert(arguments.end(), {"--csv", "a.csv"});
    const test::Outcome ended = RunPlant(arguments, folder);
    EXPECT_EQ(ended.code, 2) << words;
    EXPECT_THAT(ended.err, HasSubstr(words));
  };
  usage({"--model", "no_such_plant"}, "servo_axis");
  usage({"--model", "servo_axis", "--hide-effect", "random"}, "[[hidden]]");
  usage({"--model", "servo_axis", "--duration", "1e-6"}, "samples");
}

TEST(DescribedProgram, LeavingTheFiniteRangeEndsWithOneAndSaysWhen) {
  const test::ScratchDir folder;
  const test::Outcome ended = RunPlant({"--model", "soft_actuator", "--csv", "a.csv"}, folder);
  EXPECT_EQ(ended.code, 1);
  EXPECT_THAT(ended.err, HasSubstr("left the finite range at t = 0 s"));
}

}  // namespace
}  // namespace armcmc::plant_sim::described_program_test
