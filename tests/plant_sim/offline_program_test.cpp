// armcmc-plant as a process, without a bus.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "armcmc/data_pack_t.hpp"
#include "files.hpp"
#include "plant_program.hpp"
#include "support/paths.hpp"

namespace armcmc::plant_sim::offline_program_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(PlantProgram, WritesTheSameCsvForTheSameSeedFromAnyFolder) {
  const test::ScratchDir folder;
  ASSERT_EQ(RunPlant({"--scenario", "hunt_crossley_paper", "--seed", "3", "--csv", "a.csv"}, folder).code, 0);
  const std::string path = (test::SourceDir() / "plant_sim/scenarios/hunt_crossley_paper.toml").string();
  ASSERT_EQ(RunPlant({"--scenario", path, "--seed", "3", "--csv", "b.csv"}, folder).code, 0);
  ASSERT_EQ(RunPlant({"--seed", "4", "--csv", "c.csv"}, folder).code, 0);
  const std::string a = Text(folder / "a.csv");
  EXPECT_THAT(a, StartsWith("t,x,v,f,f_true,K_true,B_true,p_true\n0,"));
  EXPECT_EQ(std::count(a.begin(), a.end(), '\n'), 20'002);
  EXPECT_EQ(a, Text(folder / "b.csv"));
  EXPECT_NE(a, Text(folder / "c.csv"));
}

TEST(PlantProgram, WritesTheActuatorsColumns) {
  const test::ScratchDir folder;
  ASSERT_EQ(RunPlant({"--scenario", "soft_actuator_excited", "--duration", "0.1", "--csv", "a.csv"}, folder).code, 0);
  EXPECT_THAT(Text(folder / "a.csv"), StartsWith("t,u_c,u_d,p,pdot,alpha,flow,g_true,theta2_true\n"));
}

TEST(PlantProgram, WritesALogOfPacksWithoutABus) {
  const test::ScratchDir folder;
  const test::Outcome ended =
      RunPlant({"--duration", "2", "--csv", "a.csv", "--log", "a.lcm", "--prefix", "X_", "--inject", "drop@5"}, folder);
  ASSERT_EQ(ended.code, 0) << ended.err;
  lcm::LogFile log((folder / "a.lcm").string(), "r");
  ASSERT_TRUE(log.good());
  std::vector<std::int64_t> seqs;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    if (event->channel != "X_PLANT_PACK") continue;
    data_pack_t pack{};
    ASSERT_GT(pack.decode(event->data, 0, event->datalen), 0);
    seqs.push_back(pack.seq);
  }
  ASSERT_EQ(seqs.size(), 19u);
  EXPECT_EQ(seqs[3], 4);
  EXPECT_EQ(seqs[4], 6);
}

TEST(PlantProgram, AStrideMakesPacksOverlap) {
  const test::ScratchDir folder;
  const test::Outcome ended =
      RunPlant({"--duration", "0.3", "--stride", "10", "--csv", "a.csv", "--log", "a.lcm"}, folder);
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ReadTable(folder / "a.csv").rows.size(), 301u) << "a CSV has every sample once";
  lcm::LogFile log((folder / "a.lcm").string(), "r");
  std::vector<data_pack_t> packs;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    if (event->channel != "PLANT_PACK") continue;
    ASSERT_GT(packs.emplace_back().decode(event->data, 0, event->datalen), 0);
  }
  ASSERT_EQ(packs.size(), 21u);
  for (std::size_t k = 1; k < packs.size(); ++k) {
    EXPECT_EQ(packs[k].seq, static_cast<std::int64_t>(k) + 1);
    EXPECT_NEAR(packs[k].t_last_s - packs[k - 1].t_last_s, 0.01, 1e-12);
    EXPECT_EQ(packs[k].t_last_ns - packs[k - 1].t_last_ns, 10'000'000);
    EXPECT_TRUE(std::equal(packs[k].y, packs[k].y + 90, packs[k - 1].y + 10));
  }
  EXPECT_EQ(packs[0].t_last_ns, 100'000'000);
}

TEST(PlantProgram, BadUsageEndsWithTwoAndOneClearLine) {
  const test::ScratchDir folder;
  const auto expect = [&folder](const std::vector<std::string>& arguments, const std::string& words) {
    const test::Outcome ended = RunPlant(arguments, folder);
    EXPECT_EQ(ended.code, 2) << words;
    EXPECT_THAT(ended.err, HasSubstr(words));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  };
  expect({"--scenario", "no_such_scenario", "--csv", "a.csv"}, "hunt_crossley_paper");
  expect({"--duration", "-1", "--csv", "a.csv"}, "--duration");
  expect({"--duration", "nan", "--csv", "a.csv"}, "--duration");
  expect({"--duration", "0.05", "--csv", "a.csv"}, "one pack");
  expect({"--inject", "explode@3", "--csv", "a.csv"}, "explode@3");
  expect({"--prefix", "a.*b", "--csv", "a.csv"}, "--prefix");
  expect({"--csv", "a.csv", "--report", "a.json"}, "--report");
  expect({"--lcm-url", "foo://bar", "--duration", "1"}, "udpm://");
  expect({"--sed", "3"}, "--sed");
  expect({"--stride", "30", "--csv", "a.csv"}, "a divisor of the 100 samples of a pack");
  expect({"--stride", "0", "--csv", "a.csv"}, "--stride 0");
  std::ofstream(folder / "bad.toml") << "schema = 1\nplant = \"hunt_crossley\"\n[parameters]\nK = true\n";
  expect({"--scenario", "bad.toml", "--csv", "a.csv"}, "bad.toml:4");
}

TEST(PlantProgram, AFileThatCannotBeWrittenEndsWithOne) {
  const test::ScratchDir folder;
  const test::Outcome ended = RunPlant({"--csv", "no/such/folder.csv"}, folder);
  EXPECT_EQ(ended.code, 1);
  EXPECT_THAT(ended.err, HasSubstr("no/such/folder.csv"));
}

TEST(PlantProgram, HelpTeachesWithAnExample) {
  const test::ScratchDir folder;
  const test::Outcome help = RunPlant({"--help"}, folder);
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.out, HasSubstr("armcmc-plant --scenario"));
  EXPECT_EQ(RunPlant({"--version"}, folder).code, 0);
}

}  // namespace
}  // namespace armcmc::plant_sim::offline_program_test
