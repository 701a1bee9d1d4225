#include "armcmc/watch/watch_state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "armcmc/watch/names.hpp"
#include "tools/watch/watch_messages.hpp"

namespace armcmc::watch::watch_state_test {
namespace {

TEST(History, KeepsTheNewest) {
  History history;
  for (int i = 0; i < 300; ++i) history.Add(i);
  const auto newest = history.Newest(3);
  EXPECT_EQ(newest, (std::vector<double>{297, 298, 299}));
  EXPECT_EQ(history.Newest(1000).size(), History::kCapacity);
  EXPECT_TRUE(History().Newest(5).empty());
}

TEST(WatchState, CountsStepsAndNotTheStatusesOfSilence) {
  WatchState state;
  auto bytes = test::Encoded(test::SomeStatus());
  EXPECT_TRUE(state.TakeBytes("EST_STATUS", bytes.data(), static_cast<int>(bytes.size()), 0.0));
  estimator_status_t silent = test::SomeStatus();
  silent.end_to_end_ns = 0;
  bytes = test::Encoded(silent);
  EXPECT_FALSE(state.TakeBytes("EST_STATUS", bytes.data(), static_cast<int>(bytes.size()), 0.1));
  EXPECT_EQ(state.steps, 1);
  EXPECT_NEAR(state.period_s, 0.1, 1e-12);
}

TEST(WatchState, TellsForeignTypesFromCutMessages) {
  WatchState state;
  auto bytes = test::Encoded(test::SomeStatus());
  EXPECT_FALSE(state.TakeBytes("EST_ESTIMATE", bytes.data(), static_cast<int>(bytes.size()), 0.0));
  EXPECT_FALSE(state.TakeBytes("EST_STATUS", bytes.data(), 3, 0.0));
  EXPECT_EQ(state.bus.foreign, 2);
  EXPECT_FALSE(state.TakeBytes("EST_STATUS", bytes.data(), static_cast<int>(bytes.size()) - 1, 0.0));
  EXPECT_EQ(state.bus.undecodable, 1);
  EXPECT_FALSE(state.status.has_value());
}

TEST(WatchState, LetsAFaultStandUntilItWasRead) {
  WatchState state;
  estimator_status_t status = test::SomeStatus();
  status.fault_flags = estimator_status_t::FAULT_BAD_DATA;
  state.Take(status, 10.0);
  status.fault_flags = 0;
  state.Take(status, 12.0);
  EXPECT_EQ(state.held_faults, estimator_status_t::FAULT_BAD_DATA);
  state.Take(status, 13.5);
  EXPECT_EQ(state.held_faults, 0);
}

TEST(WatchState, LeavesAGapInTheMeansWhileNothingIsKnown) {
  WatchState state;
  estimate_t e = test::SomeEstimate();
  e.known = 0;
  state.Take(e, 0.0);
  EXPECT_TRUE(std::isnan(state.means[0].Newest(1).at(0)));
}

TEST(WatchState, TakesWhatIsBelievedAboutChangeFromTheBus) {
  WatchState state;
  const auto bytes = test::Encoded(test::SomeChange());
  EXPECT_FALSE(state.TakeBytes("EST_CHANGE", bytes.data(), static_cast<int>(bytes.size()), 0.0));
  ASSERT_TRUE(state.change.has_value());
  EXPECT_EQ(state.change->p_drifted[0], 0.625);
  EXPECT_EQ(state.drifted.Newest(1).at(0), 0.625);
  EXPECT_EQ(state.bus.foreign, 0);
}

TEST(Names, FollowThePlant) {
  EXPECT_EQ(ModeName(data_pack_t::PLANT_HUNT_CROSSLEY, 0), "contact");
  EXPECT_EQ(ModeName(data_pack_t::PLANT_HUNT_CROSSLEY, 1), "free");
  EXPECT_EQ(ModeName(data_pack_t::PLANT_SOFT_ACTUATOR, 2), "shut");
  EXPECT_EQ(ModeName(77, 5), "mode 5");
  EXPECT_EQ(ModeName(data_pack_t::PLANT_HUNT_CROSSLEY, -1), "mode -1");
}

TEST(Names, SayASpeed) {
  EXPECT_EQ(PerSecond("N/m^p"), "N/m^p per s");
  EXPECT_EQ(PerSecond("-"), "per s");
}

TEST(Names, NameEveryFlagAndThoseOfNewerVersions) {
  for (const std::string& words : {Joined(DegradedWords(127)), Joined(FaultWords(2047))})
    EXPECT_EQ(words.find("unknown"), std::string::npos) << words;
  EXPECT_EQ(Joined(DegradedWords(4 | 1024)), "memory not locked, unknown flag 1024");
}

TEST(Names, LetNoMessageSteerTheTerminal) {
  const std::uint8_t field[8] = {'a', 0x1b, '[', 'H', 0xff, 0, 'x', 0};
  EXPECT_EQ(FieldText(field, 8), "a?[H?");
}

TEST(TrueValue, IsThatOfTheModeThatActs) {
  estimate_t e = test::SomeEstimate();
  plant_truth_t t = test::SomeTruth();
  EXPECT_EQ(TrueValue(t, e, 0), 3.5);
  EXPECT_TRUE(std::isnan(TrueValue(t, e, 1))) << "an effect that only the model has";
  t.plant_kind = e.plant_kind = data_pack_t::PLANT_SOFT_ACTUATOR;
  t.true_mode = 1;
  EXPECT_TRUE(std::isnan(TrueValue(t, e, 0)));
  e.mode = 1;
  EXPECT_EQ(TrueValue(t, e, 0), 3.5);
}

}  // namespace
}  // namespace armcmc::watch::watch_state_test
