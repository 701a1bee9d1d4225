#include "gap_log.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/support/csv.hpp"
#include "full_disk.hpp"
#include "support/paths.hpp"

namespace armcmc::app::gap_log_test {
namespace {

class GapLogTest : public ::testing::Test {
 protected:
  GapLogSettings Settings() const {
    GapLogSettings settings;
    settings.directory = (dir_ / "logs");
    settings.window_s = 3.0;
    settings.after_s = 1.0;
    return settings;
  }
  std::unique_ptr<GapLog> Make(const GapLogSettings& settings, std::vector<std::string> columns = {"x", "v", "f"}) {
    return std::make_unique<GapLog>(settings, std::move(columns), &ring_, &alarm_,
                                    [this](const std::string& line) { said_.push_back(line); });
  }
  void Send(GapLog* log, std::int64_t seq, std::int64_t run_id = 1) {
    DataPack* pack = ring_.Claim();
    ASSERT_NE(pack, nullptr);
    *pack = DataPack{};
    pack->seq = seq;
    pack->run_id = run_id;
    pack->dt = 1e-3;
    pack->num_samples = 100;
    pack->num_inputs = 2;
    pack->t_last_s = 0.1 * static_cast<double>(seq);
    for (std::size_t n = 0; n < 100; ++n) {
      pack->u[n] = {0.25 * static_cast<double>(seq), -0.5, 7.0, 8.0};
      pack->y[n] = 1.0 / 3.0;
    }
    ring_.Commit();
    log->Poll();
  }
  support::CsvSamples Read(const std::string& path) {
    return support::ReadCsv(path, {{"t", "x", "v", "f"}, {}, false});
  }
  std::size_t Files() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(Settings().directory)) {
      EXPECT_EQ(entry.path().extension(), ".csv") << "nothing half written stays";
      ++count;
    }
    return count;
  }

  armcmc::test::ScratchDir dir_;
  rt::RecordRing ring_;
  std::atomic<std::int64_t> alarm_{0};
  std::vector<std::string> said_;
};

TEST_F(GapLogTest, WritesNothingWithoutAnAlarm) {
  auto log = Make(Settings());
  for (std::int64_t seq = 1; seq <= 50; ++seq) Send(log.get(), seq);
  log->Stop();
  EXPECT_TRUE(log->path().empty());
  EXPECT_FALSE(std::filesystem::exists(Settings().directory));
  EXPECT_TRUE(said_.empty());
}

TEST_F(GapLogTest, WritesSamplesThatPacksShareOnce) {
  GapLogSettings settings = Settings();
  settings.overlap = 10;
  auto log = Make(settings);
  const auto send = [&](std::int64_t seq, std::int64_t run_id) {
    DataPack* pack = ring_.Claim();
    ASSERT_NE(pack, nullptr);
    pack->seq = seq;
    pack->run_id = run_id;
    pack->dt = 1e-3;
    pack->num_samples = 100;
    pack->num_inputs = 2;
    pack->t_last_s = 0.099 + 0.01 * static_cast<double>(seq - 1);
    for (std::size_t n = 0; n < 100; ++n) {
      const double number = static_cast<double>(10 * (seq - 1)) + static_cast<double>(n);
      pack->u[n] = {number, -number};
      pack->y[n] = number;
    }
    ring_.Commit();
    log->Poll();
  };
  for (std::int64_t seq = 1; seq <= 5; ++seq) send(seq, 1);
  // Another run; some packs of it are lost, and as many that not all of their samples came with others.
  for (const std::int64_t seq : {1, 2, 3, 7, 8, 25, 26}) send(seq, 2);
  alarm_ = 26;
  log->Poll();
  ASSERT_FALSE(log->path().empty());
  const auto samples = Read(log->path());
  std::vector<double> expected;
  for (int n = 0; n < 170; ++n) expected.push_back(n);    // packs 1 to 8
  for (int n = 240; n < 350; ++n) expected.push_back(n);  // packs 25 and 26
  EXPECT_EQ(samples.columns[3], expected);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(samples.columns[0][i], 1e-3 * expected[i], 1e-12);
}

TEST_F(GapLogTest, WritesTheWindowAtTheAlarmAndTheRestLater) {
  auto log = Make(Settings());
  for (std::int64_t seq = 1; seq <= 50; ++seq) Send(log.get(), seq);
  alarm_ = 50;
  log->Poll();
  ASSERT_FALSE(log->path().empty());
  auto samples = Read(log->path());
  EXPECT_EQ(samples.num_rows(), 3001u) << "2.0 to 5.0 s";
  EXPECT_EQ(samples.columns[0].front(), 2.0);
  EXPECT_EQ(samples.columns[0].back(), 5.0);
  EXPECT_EQ(samples.columns[1].back(), 12.5);
  EXPECT_EQ(samples.columns[2].back(), -0.5);
  EXPECT_EQ(samples.columns[3].back(), 1.0 / 3.0) << "to the bit";
  for (std::int64_t seq = 51; seq <= 80; ++seq) Send(log.get(), seq);
  log->Stop();
  samples = Read(log->path());
  EXPECT_EQ(samples.columns[0].front(), 2.0);
  EXPECT_EQ(samples.columns[0].back(), 6.0);
  EXPECT_EQ(log->rows(), samples.num_rows());
  EXPECT_EQ(said_.size(), 2u);
  EXPECT_EQ(Files(), 1u);
}

TEST_F(GapLogTest, TheEndOfTheRunCompletesTheFile) {
  auto log = Make(Settings());
  for (std::int64_t seq = 1; seq <= 10; ++seq) Send(log.get(), seq);
  alarm_ = 10;
  log->Poll();
  for (std::int64_t seq = 11; seq <= 14; ++seq) Send(log.get(), seq);
  log->Stop();
  EXPECT_EQ(Read(log->path()).columns[0].back(), 1.4);
}

TEST_F(GapLogTest, RunsOnAThreadOfItsOwn) {
  auto log = Make(Settings());
  for (std::int64_t seq = 1; seq <= 10; ++seq) Send(log.get(), seq);
  log->Start();
  alarm_ = 10;
  log->Stop();
  EXPECT_EQ(log->rows(), 1000u);
}

TEST_F(GapLogTest, ARunOfThePlantIsNotMixedWithTheNext) {
  auto log = Make(Settings());
  for (std::int64_t seq = 1; seq <= 20; ++seq) Send(log.get(), seq);
  for (std::int64_t seq = 1; seq <= 5; ++seq) Send(log.get(), seq, 2);
  alarm_ = 5;
  log->Poll();
  EXPECT_EQ(log->rows(), 500u);
  Send(log.get(), 1, 3);
  log->Stop();
  EXPECT_EQ(Read(log->path()).columns[0].back(), 0.5);
}

TEST_F(GapLogTest, KeepsTheNewestFilesOnly) {
  GapLogSettings settings = Settings();
  settings.max_files = 3;
  std::filesystem::create_directories(settings.directory);
  for (int i = 0; i < 5; ++i)
    std::ofstream(settings.directory + "/gap-2020010" + std::to_string(i) + "T000000Z-1.csv") << "t,x,v,f\n";
  std::ofstream(settings.directory + "/mine.csv") << "t,x,v,f\n";
  auto log = Make(settings);
  Send(log.get(), 1);
  alarm_ = 1;
  log->Poll();
  EXPECT_TRUE(std::filesystem::exists(log->path()));
  EXPECT_EQ(Files(), 4u) << "three of ours, and what somebody else put there";
  EXPECT_TRUE(std::filesystem::exists(settings.directory + "/mine.csv"));
}

TEST_F(GapLogTest, AFullDiskIsSaidAndLeavesNothing) {
  auto log = Make(Settings());
  for (std::int64_t seq = 1; seq <= 10; ++seq) Send(log.get(), seq);
  alarm_ = 10;
  {
    const test::FullDisk full(4096);
    log->Poll();
  }
  EXPECT_TRUE(log->path().empty());
  ASSERT_EQ(said_.size(), 1u);
  EXPECT_NE(said_[0].find("could not be written"), std::string::npos) << said_[0];
  EXPECT_EQ(Files(), 0u);
  log->Stop();
  EXPECT_EQ(said_.size(), 1u) << "said once";
}

TEST_F(GapLogTest, AnActuatorHasItsOwnColumns) {
  auto log = Make(Settings(), {"u_c", "u_d", "p", "pdot", "alpha"});
  Send(log.get(), 1);
  alarm_ = 1;
  log->Poll();
  const auto samples = support::ReadCsv(log->path(), {{"t", "u_c", "u_d", "p", "pdot", "alpha"}, {}, false});
  ASSERT_EQ(samples.num_rows(), 100u);
  EXPECT_EQ(samples.columns[4].front(), 8.0);
  EXPECT_EQ(samples.columns[5].front(), 1.0 / 3.0);
}

TEST_F(GapLogTest, MemoryIsBounded) {
  GapLogSettings settings = Settings();
  settings.window_s = 3600.0;
  auto log = Make(settings);
  const auto packs = static_cast<std::int64_t>(GapLog::kMaxRows / 100) + 50;
  for (std::int64_t seq = 1; seq <= packs; ++seq) Send(log.get(), seq);
  alarm_ = packs;
  log->Poll();
  EXPECT_EQ(log->rows(), GapLog::kMaxRows);
}

}  // namespace
}  // namespace armcmc::app::gap_log_test
