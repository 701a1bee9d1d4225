#include "armcmc/plant_sim/pack_sender.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "armcmc/plant_sim/pack_builder.hpp"
#include "builtin_scenario.hpp"
#include "recording_sink.hpp"

namespace armcmc::plant_sim::pack_sender_test {
namespace {

using testing::ElementsAre;

/// Sends so many packs with these faults.
RecordingSink SendPacks(int num_packs, const std::string& faults, const std::string& prefix = "") {
  RecordingSink sink;
  PackSender sender(prefix, faults.empty() ? FaultPlan() : FaultPlan::Parse(faults), &sink);
  PackBuilder builder(BuiltinScenario("hunt_crossley_paper"), 1, 1);
  for (int k = 1; k <= num_packs; ++k) {
    EXPECT_TRUE(builder.Next());
    builder.Stamp(k * 100, k);
    sender.Send(builder.pack(), builder.truth());
  }
  sender.Flush();
  EXPECT_EQ(sender.errors(), 0);
  return sink;
}

data_pack_t Decode(const RecordingSink::Message& message) {
  data_pack_t pack{};
  EXPECT_GT(pack.decode(message.bytes.data(), 0, static_cast<int>(message.bytes.size())), 0);
  return pack;
}

TEST(PackSender, SendsEveryPackAndItsTruthUnderThePrefix) {
  const RecordingSink sink = SendPacks(3, "", "B_");
  EXPECT_THAT(sink.Seqs("B_PLANT_PACK"), ElementsAre(1, 2, 3));
  ASSERT_EQ(sink.On("B_PLANT_TRUTH").size(), 3u);
  plant_truth_t truth{};
  const RecordingSink::Message last = sink.On("B_PLANT_TRUTH").back();
  ASSERT_GT(truth.decode(last.bytes.data(), 0, static_cast<int>(last.bytes.size())), 0);
  EXPECT_EQ(truth.seq, 3);
  EXPECT_EQ(truth.theta_true[0], 4.0);
  EXPECT_EQ(Decode(sink.On("B_PLANT_PACK")[1]).t_last_ns, 200);
}

TEST(PackSender, DropsDuplicatesAndReorders) {
  EXPECT_THAT(SendPacks(4, "drop@2").Seqs("PLANT_PACK"), ElementsAre(1, 3, 4));
  EXPECT_THAT(SendPacks(4, "duplicate@2").Seqs("PLANT_PACK"), ElementsAre(1, 2, 2, 3, 4));
  EXPECT_THAT(SendPacks(4, "reorder@2").Seqs("PLANT_PACK"), ElementsAre(1, 3, 2, 4));
  EXPECT_THAT(SendPacks(4, "reorder@2,reorder@3").Seqs("PLANT_PACK"), ElementsAre(1, 2, 4, 3));
  EXPECT_THAT(SendPacks(2, "reorder@2").Seqs("PLANT_PACK"), ElementsAre(1, 2)) << "nothing follows the last";
}

TEST(PackSender, SpoilsTheContentOfOnePackOnly) {
  const RecordingSink sink = SendPacks(3, "nan@1,size@2");
  const std::vector<RecordingSink::Message> packs = sink.On("PLANT_PACK");
  ASSERT_EQ(packs.size(), 3u);
  EXPECT_TRUE(std::isnan(Decode(packs[0]).y[50]));
  EXPECT_FALSE(std::isnan(Decode(packs[0]).y[49]));
  EXPECT_EQ(Decode(packs[1]).n_samples, 257);
  EXPECT_EQ(Decode(packs[2]).n_samples, 100);
  for (const double y : Decode(packs[2]).y) EXPECT_FALSE(std::isnan(y));
}

TEST(PackSender, ZeroesBlowsUpAndDamagesOnePackOnly) {
  const RecordingSink sink = SendPacks(4, "zero@1,huge@2,corrupt@3");
  const std::vector<RecordingSink::Message> packs = sink.On("PLANT_PACK");
  ASSERT_EQ(packs.size(), 4u);
  const data_pack_t zero = Decode(packs[0]), huge = Decode(packs[1]), corrupt = Decode(packs[2]);
  EXPECT_EQ(zero.seq, 1);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(zero.y[i], 0.0);
    EXPECT_EQ(zero.u[i][0], 0.0);
  }
  EXPECT_EQ(huge.y[50], 1e300);
  EXPECT_LT(std::abs(huge.y[49]), 1e3);
  EXPECT_NE(huge.u[50][0], 0.0);
  EXPECT_NE(corrupt.seq, 3) << "the type is whole, all behind it is not";
  EXPECT_EQ(Decode(packs[3]).seq, 4);
  EXPECT_LT(std::abs(Decode(packs[3]).y[50]), 1e3);
}

TEST(PackSender, AJumpOfTheClockShowsInThePackAloneAndStays) {
  const RecordingSink sink = SendPacks(3, "clock@2:1.5");
  const std::vector<RecordingSink::Message> packs = sink.On("PLANT_PACK");
  ASSERT_EQ(packs.size(), 3u);
  EXPECT_EQ(Decode(packs[0]).t_last_ns, 100);
  EXPECT_EQ(Decode(packs[1]).t_last_ns, 200 + 1'500'000);
  EXPECT_EQ(Decode(packs[2]).t_last_ns, 300 + 1'500'000);
}

TEST(PackSender, PutsForeignAndUndecodableMessagesBeforeThePack) {
  const RecordingSink sink = SendPacks(3, "foreign@2,garbage@3");
  EXPECT_THAT(sink.Seqs("PLANT_PACK"), ElementsAre(1, -1, 2, -1, 3));
  const RecordingSink::Message foreign = sink.On("PLANT_PACK")[1];
  plant_truth_t truth{};
  EXPECT_GT(truth.decode(foreign.bytes.data(), 0, static_cast<int>(foreign.bytes.size())), 0);
}

TEST(PackSender, CountsWhatTheBusDoesNotTake) {
  RecordingSink sink;
  sink.Break();
  PackSender sender("", FaultPlan(), &sink);
  PackBuilder builder(BuiltinScenario("hunt_crossley_paper"), 1, 1);
  ASSERT_TRUE(builder.Next());
  sender.Send(builder.pack(), builder.truth());
  EXPECT_EQ(sender.errors(), 2);
}

}  // namespace
}  // namespace armcmc::plant_sim::pack_sender_test
