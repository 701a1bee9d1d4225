#include "armcmc/watch/step_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/json.hpp"
#include "tools/watch/watch_messages.hpp"

namespace armcmc::watch::step_text_test {
namespace {

using ::testing::HasSubstr;

TEST(StepLine, HoldsWhatMattersAndNoLineEnd) {
  EXPECT_EQ(StepLine(test::SomeState()),
            "pack 11  contact  K 3.25 +- 0.5  zeta 0.25/1.5  lambda 0.75  ESS 1234  drifted 62.5 %  52 of 100 ms  "
            "missed 0/0/0");
}

TEST(StepLine, NamesWhatIsWrong) {
  WatchState state = test::SomeState();
  state.status->degraded_flags = estimator_status_t::DEGRADED_NO_MLOCK;
  state.status->fault_flags = estimator_status_t::FAULT_BAD_DATA;
  state.status->packs_lost = 4;
  state.status->gap_suspected = 1;
  test::SetText("depth", state.status->gap_where);
  EXPECT_THAT(StepLine(state), HasSubstr("lost 4  FAULTS bad data  DEGRADED memory not locked  MODEL GAP depth"));
}

TEST(StepJson, IsOneObjectWithTheSameNumbers) {
  const auto json = test::Json::Parse(StepJson(test::SomeState()));
  EXPECT_EQ(json["pack"], 11);
  EXPECT_EQ(json["parameters"]["K"]["mean"], 3.25);
  EXPECT_EQ(json["parameters"]["K"]["truth"], 3.5);
  EXPECT_EQ(json["parameters"]["K"]["unit"], "N/m^p");
  EXPECT_EQ(json["stage_ms"]["adjust"], 50.0);
  EXPECT_EQ(json["slack_ms"], 48.0);
  EXPECT_EQ(json["misses"]["own"], 0);
  EXPECT_EQ(json["mode"], "contact");
  EXPECT_EQ(json["degraded"].size(), 0u);
  const auto& change = json["change"]["contact"];
  EXPECT_EQ(change["persisted"], 0.25);
  EXPECT_EQ(change["drifted"], 0.625);
  EXPECT_EQ(change["changed"], 0.125);
  EXPECT_EQ(change["drift_rate"]["K"]["value"], 0.0375);
  EXPECT_EQ(change["drift_rate"]["K"]["unit"], "N/m^p per s");
}

TEST(StepJson, WritesNullForWhatIsNotKnown) {
  WatchState state = test::SomeState();
  state.estimate->known = 0;
  state.estimate->zeta = std::numeric_limits<double>::quiet_NaN();
  const auto json = test::Json::Parse(StepJson(state));
  EXPECT_TRUE(json["parameters"]["K"]["mean"].is_null());
  EXPECT_TRUE(json["zeta"].is_null());
}

TEST(StepJson, DoesWithoutAnEstimate) {
  WatchState state;
  state.Take(test::SomeStatus(), 0.0);
  EXPECT_EQ(test::Json::Parse(StepJson(state))["deadline_ms"], 100.0);
  EXPECT_THAT(StepLine(state), HasSubstr("52 of 100 ms"));
}

}  // namespace
}  // namespace armcmc::watch::step_text_test
