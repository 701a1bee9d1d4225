// armcmc-plant --recording as a process, on a bus inside of it and into a log.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "armcmc/data_pack_v2_t.hpp"
#include "plant_program.hpp"
#include "support/paths.hpp"

namespace armcmc::plant_sim::recording_program_test {
namespace {

using testing::HasSubstr;

/// A thermometer in two runs of 250 and 130 samples, 1 kHz, and the plant that it belongs to.
void WriteRecording(const test::ScratchDir& folder) {
  std::ofstream(folder / "thermometer.toml")
      << "schema = 1\nname = \"thermometer\"\noutput = \"T\"\nlaw = \"a + b*u\"\n"
         "[signals]\nu = { unit = \"V\", role = \"drive\" }\nT = { unit = \"K\", role = \"level\" }\n"
         "[parameters]\na = { unit = \"K\", mean = 0.0, sd = 1.0 }\nb = { unit = \"K/V\", mean = 0.0, sd = 1.0 }\n"
         "[noise]\nlaw = \"gaussian\"\nstd = 1.0\n";
  std::ofstream(folder / "day.toml") << "schema = 1\nmodel = \"thermometer.toml\"\nfile = \"day.csv\"\n"
                                        "[columns]\nt = { column = \"s\" }\nu = { column = \"volt\" }\n"
                                        "T = { column = \"kelvin\", scale = 2.0 }\n[rows]\nsegment_column = \"day\"\n";
  std::ofstream csv(folder / "day.csv");
  csv << "s,volt,kelvin,day\n";
  for (int n = 0; n < 380; ++n) csv << 1e-3 * n << ',' << n << ',' << 0.5 * n + 100 << ',' << (n < 250 ? 1 : 2) << '\n';
}

std::vector<data_pack_v2_t> ReadPacks(const std::filesystem::path& path) {
  std::vector<data_pack_v2_t> packs;
  lcm::LogFile log(path.string(), "r");
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    EXPECT_EQ(event->channel, "P_PLANT_PACK_V2");
    data_pack_v2_t pack{};
    EXPECT_EQ(pack.decode(event->data, 0, event->datalen), event->datalen);
    packs.push_back(pack);
  }
  return packs;
}

TEST(RecordingProgram, PlaysRunAfterRunAndSaysWhatItSent) {
  const test::ScratchDir folder;
  WriteRecording(folder);
  const test::Outcome ended = RunPlant(
      {"--recording", "day.toml", "--lcm-url", "memq://", "--speed", "100", "--log", "a.lcm", "--prefix", "P_"},
      folder);
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("3 packs of 100 samples of thermometer, one every 1 ms"));
  EXPECT_THAT(ended.out, HasSubstr("3 of 3 packs sent, 2 runs"));
  EXPECT_THAT(ended.out, HasSubstr("80 samples at the ends of runs fill no pack"));
  const std::vector<data_pack_v2_t> packs = ReadPacks(folder / "a.lcm");
  ASSERT_EQ(packs.size(), 3u);
  EXPECT_EQ(packs[0].seq, 1);
  EXPECT_EQ(packs[1].seq, 2);
  EXPECT_EQ(packs[2].seq, 1);
  EXPECT_EQ(packs[0].run_id, packs[1].run_id);
  EXPECT_NE(packs[0].run_id, packs[2].run_id);
  EXPECT_DOUBLE_EQ(packs[1].t_last_s, 0.199);
  EXPECT_DOUBLE_EQ(packs[2].t_last_s, 0.099);
  EXPECT_EQ(packs[2].t_last_ns - packs[1].t_last_ns, 1'000'000);
  EXPECT_DOUBLE_EQ(packs[1].u[99][0], 199.0);
  EXPECT_DOUBLE_EQ(packs[2].y[0], 2.0 * (0.5 * 250 + 100));
  EXPECT_EQ(packs[0].y_name[0], 'T');
  EXPECT_EQ(packs[0].u_unit[0][0], 'V');
}

TEST(RecordingProgram, AStrideMakesPacksOverlap) {
  const test::ScratchDir folder;
  WriteRecording(folder);
  const test::Outcome ended = RunPlant({"--recording", "day.toml", "--lcm-url", "memq://", "--speed", "10", "--log",
                                        "a.lcm", "--prefix", "P_", "--stride", "25"},
                                       folder);
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("9 packs of 100 samples of thermometer, one every 2.5 ms"));
  EXPECT_THAT(ended.out, HasSubstr("9 of 9 packs sent, 2 runs"));
  EXPECT_THAT(ended.out, HasSubstr("5 samples at the ends of runs fill no pack"));
  const std::vector<data_pack_v2_t> packs = ReadPacks(folder / "a.lcm");
  ASSERT_EQ(packs.size(), 9u);
  EXPECT_DOUBLE_EQ(packs[1].u[0][0], 25.0);
  EXPECT_DOUBLE_EQ(packs[1].t_last_s, 0.124);
  EXPECT_DOUBLE_EQ(packs[8].u[0][0], 275.0) << "the second pack of the second run";
  EXPECT_EQ(packs[8].seq, 2);
  const test::Outcome wrong = RunPlant({"--recording", "day.toml", "--lcm-url", "memq://", "--stride", "30"}, folder);
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("a divisor of the 100 samples of a pack"));
}

TEST(RecordingProgram, PlaysEmpsToItsLastPack) {
  ARMCMC_REQUIRE_DATA("measured/emps_estimation.csv");
  const test::ScratchDir folder;
  const std::string data = test::FindData("measured/emps_estimation.csv")->parent_path().string();
  std::ofstream(folder / "emps.toml")
      << "schema = 1\nmodel = \"servo_axis\"\nfile = \"emps_estimation.csv\"\n[columns]\nt = { column = \"t_s\" }\n"
         "q = { column = \"q_meas_m\" }\nF = { column = \"vir_V\", scale = 35.15065188248547 }\n"
         "[derivatives]\nbandwidth_hz = 40\nfiltered_with = [\"F\"]\n";
  const test::Outcome ended =
      RunPlant({"--recording", "emps.toml", "--data-dir", data, "--lcm-url", "memq://", "--speed", "1e4"}, folder);
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("248 of 248 packs sent"));  // 24 841 samples at 1 kHz
}

TEST(RecordingProgram, BadUsageEndsWithTwoAndOneClearLine) {
  const test::ScratchDir folder;
  WriteRecording(folder);
  const auto expect = [&folder](std::vector<std::string> arguments, const std::string& words) {
    arguments.insert(arguments.end(), {"--lcm-url", "memq://"});
    const test::Outcome ended = RunPlant(arguments, folder);
    EXPECT_EQ(ended.code, 2) << words;
    EXPECT_THAT(ended.err, HasSubstr(words));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  };
  expect({"--recording", "none.toml"}, "none.toml");
  expect({"--recording", "day.toml", "--speed", "0"}, "--speed");
  expect({"--recording", "day.toml", "--speed", "nan"}, "--speed");
  expect({"--recording", "day.toml", "--csv", "a.csv"}, "--csv contradicts --recording");
  expect({"--recording", "day.toml", "--scenario", "contact_rich"}, "--scenario contradicts --recording");
  expect({"--speed", "2", "--duration", "1"}, "--speed needs --recording");
  expect({"--data-dir", ".", "--duration", "1"}, "--data-dir needs --recording");
  std::ofstream(folder / "short.toml") << "schema = 1\nmodel = \"thermometer.toml\"\nfile = \"short.csv\"\n"
                                          "[columns]\nt = { column = \"s\" }\n";
  std::ofstream csv(folder / "short.csv");
  csv << "s,u,T\n";
  for (int n = 0; n < 50; ++n) csv << 1e-3 * n << ",1," << n << '\n';
  csv.close();
  expect({"--recording", "short.toml"}, "no run has the 100 samples of a pack");
}

}  // namespace
}  // namespace armcmc::plant_sim::recording_program_test
