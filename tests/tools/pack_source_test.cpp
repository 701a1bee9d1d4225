#include "armcmc/replay/pack_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "armcmc/support/program.hpp"
#include "plants/soft_actuator/model.hpp"
#include "support/paths.hpp"
#include "tools/replay_data.hpp"

namespace armcmc::replay::pack_source_test {
namespace {

using support::InputError;
using ::testing::Contains;
using ::testing::HasSubstr;

class PackSourceTest : public ::testing::Test {
 protected:
  SourceRequest Csv(const std::string& text) {
    std::ofstream(dir_ / "d.csv", std::ios::binary) << text;
    request_.data = dir_ / "d.csv";
    return request_;
  }
  std::vector<RecordedPack> ReadAll() {
    source_ = OpenSource(request_);
    std::vector<RecordedPack> packs;
    RecordedPack next;
    while (source_->Next(&next)) packs.push_back(next);
    return packs;
  }
  std::string ErrorOf() {
    try {
      ReadAll();
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "no InputError was thrown";
    return "";
  }

  test::ScratchDir dir_;
  SourceRequest request_ = ContactRequest();
  std::unique_ptr<PackSource> source_;
};

TEST_F(PackSourceTest, CsvPackKHoldsTheSamplesAfterKMinusOneTimesN) {
  Csv(ContactCsv(331));
  const auto packs = ReadAll();
  ASSERT_EQ(packs.size(), 3u);
  for (int k = 1; k <= 3; ++k) {
    const DataPack& pack = packs[static_cast<std::size_t>(k - 1)].pack;
    EXPECT_EQ(pack.seq, k);
    EXPECT_EQ(pack.num_samples, 100);
    EXPECT_EQ(pack.num_inputs, 2);
    EXPECT_EQ(pack.dt, 0.001) << "exactly, although differences of decimals are not";
    EXPECT_EQ(pack.t_last_s, k / 10.0);
    EXPECT_EQ(pack.u[0][0], ContactAt(100 * k - 99).x);
    EXPECT_EQ(pack.u[99][1], ContactAt(100 * k).v);
    EXPECT_EQ(pack.y[99], ContactAt(100 * k).f);
    EXPECT_EQ(pack.Validate(), Status::kOk);
  }
  EXPECT_THAT(source_->notes(), Contains(HasSubstr("the last 30 samples do not fill a pack")));
  EXPECT_EQ(source_->progress(), 1.0);
}

TEST_F(PackSourceTest, CsvPacksOverlapByWhatTheSettingsSay) {
  Csv(ContactCsv(331));
  request_.period = 0.025;
  request_.overlap = 4;
  const auto packs = ReadAll();
  ASSERT_EQ(packs.size(), 10u) << "the last one ends at 325";
  for (int k = 1; k <= 10; ++k) {
    const DataPack& pack = packs[static_cast<std::size_t>(k - 1)].pack;
    EXPECT_EQ(pack.seq, k);
    EXPECT_EQ(pack.num_samples, 100);
    EXPECT_DOUBLE_EQ(pack.t_last_s, 0.1 + 0.025 * (k - 1));
    EXPECT_EQ(pack.u[0][0], ContactAt(25 * (k - 1) + 1).x);
    EXPECT_EQ(pack.y[99], ContactAt(25 * (k - 1) + 100).f);
  }
  EXPECT_THAT(source_->notes(), Contains(HasSubstr("the last 5 samples do not fill a pack")));
  request_.one_recursion = true;
  const auto of_one = ReadAll();
  ASSERT_EQ(of_one.size(), 2u);
  EXPECT_EQ(of_one[0].pack.seq, 4);
  EXPECT_EQ(of_one[1].pack.seq, 8);
  EXPECT_EQ(of_one[1].pack.y, packs[7].pack.y);
  request_.period = 0.1;  // 400 samples
  EXPECT_THAT(ErrorOf(), HasSubstr("into 1 to 64 samples; change timing.period_ms or timing.overlap"));
}

TEST_F(PackSourceTest, AGapInACsvIsLeftOutOfAllPacksThatOverlapIt) {
  std::string text = ContactCsv(601);
  const std::size_t from = text.find("\n0.101,"), to = text.find("\n0.401,");
  text.erase(from, to - from);  // the samples 101 to 400
  Csv(text);
  request_.period = 0.025;
  request_.overlap = 4;
  const auto packs = ReadAll();
  // Of pack k with the samples 25 (k - 1) + 1 .. 25 (k - 1) + 100: what is left.
  std::vector<std::pair<std::int64_t, int>> seen, expected;
  for (const RecordedPack& p : packs) seen.emplace_back(p.pack.seq, p.pack.num_samples);
  for (int k = 1; k <= 21; ++k) {
    const int left = std::clamp(100 - 25 * (k - 1), 0, 100) + std::clamp(25 * (k - 1) + 100 - 400, 0, 100);
    if (left > 0) expected.emplace_back(k, left);
  }
  EXPECT_EQ(seen, expected);
  EXPECT_EQ(source_->counts().lost, 21 - static_cast<std::int64_t>(expected.size()));
  EXPECT_EQ(packs.back().pack.y[99], ContactAt(600).f);
}

TEST_F(PackSourceTest, CsvAndLogGiveTheSamePacks) {
  Csv(ContactCsv(301));
  const auto from_csv = ReadAll();
  request_.data = dir_ / "d.lcm";
  {
    LogWriter log(request_.data);
    for (int k = 1; k <= 3; ++k) log.Write("PLANT_PACK", ContactPack(k));
  }
  const auto from_log = ReadAll();
  ASSERT_EQ(from_log.size(), from_csv.size());
  for (std::size_t k = 0; k < from_csv.size(); ++k) {
    EXPECT_EQ(from_log[k].pack.seq, from_csv[k].pack.seq);
    EXPECT_EQ(from_log[k].pack.y, from_csv[k].pack.y);
    EXPECT_EQ(from_log[k].pack.u, from_csv[k].pack.u);
    EXPECT_EQ(from_log[k].pack.dt, from_csv[k].pack.dt);
    EXPECT_NEAR(from_log[k].t[0], from_csv[k].t[0], 1e-12);
  }
}

TEST_F(PackSourceTest, TooFewRowsAndOddPeriodsAreErrors) {
  Csv(ContactCsv(100));
  EXPECT_THAT(ErrorOf(), HasSubstr("100 rows do not fill a pack"));
  Csv(ContactCsv(1));
  EXPECT_THAT(ErrorOf(), HasSubstr("one row is too few"));
  Csv(ContactCsv(500));
  request_.period = 0.0123456;
  EXPECT_THAT(ErrorOf(), HasSubstr("change timing.period_ms"));
  request_.period = 0.3;  // 300 samples
  EXPECT_THAT(ErrorOf(), HasSubstr("into 1 to 256 samples"));
}

TEST_F(PackSourceTest, ASkippedRowLeavesAGapInItsPackAlone) {
  std::string text = ContactCsv(301);
  const std::size_t row = text.find("\n0.150,") + 1;
  text.replace(row + 6, 1, "x");
  Csv(text);
  EXPECT_THAT(ErrorOf(), HasSubstr("d.csv:152:"));
  request_.skip_bad = true;
  const auto packs = ReadAll();
  ASSERT_EQ(packs.size(), 3u);
  EXPECT_EQ(packs[1].pack.num_samples, 99);
  EXPECT_EQ(packs[2].pack.num_samples, 100);
  EXPECT_EQ(packs[2].pack.y[0], ContactAt(201).f);
  EXPECT_THAT(source_->notes(), Contains(HasSubstr("1 packs are used although samples are missing")));
}

TEST_F(PackSourceTest, APackWithoutSamplesIsLost) {
  std::string text = ContactCsv(401);
  const std::size_t from = text.find("\n0.101,"), to = text.find("\n0.201,");
  text.erase(from, to - from);
  Csv(text);
  const auto packs = ReadAll();
  ASSERT_EQ(packs.size(), 3u);
  EXPECT_EQ(packs[0].pack.seq, 1);
  EXPECT_EQ(packs[1].pack.seq, 3);
  EXPECT_EQ(source_->counts().lost, 1);
}

TEST_F(PackSourceTest, AGapOfMonthsIsCountedAtOnce) {
  std::string text = ContactCsv(301);  // up to 0.3 s
  for (int n = 1; n <= 200; ++n) {
    char row[64];
    std::snprintf(row, sizeof(row), "%.3f,0.001,0.1,2.5\n", 1e7 + n * 0.001);
    text += row;
  }
  Csv(text);
  const auto packs = ReadAll();
  ASSERT_EQ(packs.size(), 5u);
  EXPECT_EQ(packs[3].pack.seq, 100'000'001);
  EXPECT_EQ(source_->counts().lost, 100'000'000 - 3);
}

TEST_F(PackSourceTest, AnActuatorPackWithAGapIsLostBecauseItsAngleIsIntegrated) {
  std::string text = "t,u_c,u_d,p,alpha\n";
  for (int i = 0; i <= 300; ++i) {
    if (i == 150) continue;
    const double t = i * 0.001;
    text += support::ExactNumber(t) + ",0.1,0," + support::ExactNumber(101325.0 + t) + ",0.5\n";
  }
  Csv(text);
  request_.plant = SoftActuator::kInfo.plant;
  const auto packs = ReadAll();
  ASSERT_EQ(packs.size(), 2u);
  EXPECT_EQ(packs[1].pack.seq, 3);
  EXPECT_EQ(packs[1].pack.num_inputs, 4);
  EXPECT_NEAR(packs[1].pack.u[50][3], 1.0, 1e-6);  // pdot, derived
  EXPECT_EQ(source_->counts().lost, 1);
  EXPECT_THAT(source_->notes(), Contains(HasSubstr("column pdot is missing")));
}

TEST_F(PackSourceTest, LogPacksAreCheckedAndSequencedAsLive) {
  request_.data = dir_ / "d.lcm";
  {
    LogWriter log(request_.data);
    log.Write("PLANT_PACK", ContactPack(1));
    log.Write("PLANT_PACK", ContactPack(1));  // again
    log.Write("OTHER_PLANT_PACK", ContactPack(2));
    log.Write("PLANT_PACK", ContactPack(4));  // 2 and 3 are missing
    log.Write("PLANT_PACK", ContactPack(3));  // late
    data_pack_t bad = ContactPack(5);
    bad.y[7] = std::numeric_limits<double>::quiet_NaN();
    log.Write("PLANT_PACK", bad);
    log.Write("PLANT_PACK", estimate_t{});  // another type
    log.Write("PLANT_PACK", ContactPack(6));
  }
  const auto packs = ReadAll();
  ASSERT_EQ(packs.size(), 3u);
  EXPECT_EQ(packs[2].pack.seq, 6);
  const PackCounts counts = source_->counts();
  EXPECT_EQ(counts.duplicate, 1);
  EXPECT_EQ(counts.reordered, 1);
  EXPECT_EQ(counts.rejected, 2);
  EXPECT_EQ(counts.lost, 1);  // 2; 3 came late, 5 came but was rejected
  EXPECT_EQ(counts.unused, 0);
}

TEST_F(PackSourceTest, APrefixChoosesThePlant) {
  request_.data = dir_ / "d.lcm";
  {
    LogWriter log(request_.data);
    log.Write("A_PLANT_PACK", ContactPack(1));
    log.Write("B_PLANT_PACK", ContactPack(1));
    log.Write("B_PLANT_PACK", ContactPack(2));
  }
  EXPECT_THAT(ErrorOf(), HasSubstr("it has A_PLANT_PACK, B_PLANT_PACK"));
  request_.prefix = "B_";
  EXPECT_EQ(ReadAll().size(), 2u);
}

TEST_F(PackSourceTest, EstimatesInTheLogSayWhichPacksWereUsedAndHowFar) {
  request_.data = dir_ / "d.lcm";
  {
    LogWriter log(request_.data);
    for (int k = 1; k <= 4; ++k) log.Write("PLANT_PACK", ContactPack(k));
    for (int k = 2; k <= 4; ++k) {  // the estimator came late to pack 1
      estimate_t estimate{};
      estimate.seq = k;
      estimate.run_id = 77;
      estimate.n_modes = 1;
      estimate.draws_by_mode[0] = k == 2 ? 0 : 1000 * k;  // the second pack was held
      log.Write("EST_ESTIMATE", estimate);
    }
  }
  const auto packs = ReadAll();
  ASSERT_EQ(packs.size(), 3u);
  EXPECT_EQ(packs[0].pack.seq, 2);
  EXPECT_EQ(packs[0].limits, kNoDrawLimits);
  EXPECT_EQ(packs[1].limits[0], 3000);
  EXPECT_EQ(source_->counts().unused, 1);
  EXPECT_THAT(source_->notes(), Contains(HasSubstr("1 packs that have none are left out")));

  // The same record for the same packs as CSV, which knows no runs.
  const auto log = request_.data;
  Csv(ContactCsv(401));
  request_.draws_from = log;
  const auto from_csv = ReadAll();
  ASSERT_EQ(from_csv.size(), 3u);
  EXPECT_EQ(from_csv[1].limits[0], 3000);
}

TEST_F(PackSourceTest, DrawsOfAnEstimateCsvAreRepeated) {
  std::ofstream(dir_ / "live.csv") << "pack,t,draws\n1,0.1,0\n2,0.2,500\n";
  Csv(ContactCsv(301));
  request_.draws_from = dir_ / "live.csv";
  const auto packs = ReadAll();
  ASSERT_EQ(packs.size(), 2u);
  EXPECT_EQ(packs[0].limits, kNoDrawLimits) << "a held pack is no limit";
  EXPECT_EQ(packs[1].limits[0], 500);
}

TEST_F(PackSourceTest, LogsAreToldByContentOrName) {
  std::ofstream(dir_ / "a.bin", std::ios::binary) << "\xED\xA1\xDA\x01rest";
  std::ofstream(dir_ / "a.csv") << "t,x\n";
  EXPECT_TRUE(IsLcmLog(dir_ / "a.bin"));
  EXPECT_FALSE(IsLcmLog(dir_ / "a.csv"));
  EXPECT_TRUE(IsLcmLog(dir_ / "absent.lcm"));
  EXPECT_FALSE(IsLcmLog(dir_ / "absent.csv"));
}

}  // namespace
}  // namespace armcmc::replay::pack_source_test
