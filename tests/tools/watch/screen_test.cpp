#include "armcmc/watch/screen.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tools/watch/watch_messages.hpp"

namespace armcmc::watch::screen_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

View Plain(int columns = 140, int rows = 50) {
  View view;
  view.columns = columns;
  view.rows = rows;
  view.colour = false;
  return view;
}

TEST(Screen, SaysWhatItWaitsFor) {
  WatchState state;
  state.url = "udpm://239.255.76.67:7999?ttl=0";
  state.prefix = "left_";
  EXPECT_THAT(Render(state, Plain(), 3.0),
              HasSubstr("waiting for left_EST_STATUS on udpm://239.255.76.67:7999?ttl=0: is the estimator running? "
                        "same URL and prefix?"));
}

TEST(Screen, ShowsTheParameterWithIntervalDensityAndTruth) {
  const std::string text = Render(test::SomeState(), Plain(), 1.1);
  for (const char* part : {"K ", "N/m^p", "3.25", "0.5", "[2, 4.5]", "3.5", "█"}) EXPECT_THAT(text, HasSubstr(part));
}

TEST(Screen, ShowsStagesAgainstTheDeadlineAndTheSampler) {
  const std::string text = Render(test::SomeState(), Plain(), 1.1);
  for (const char* part : {"adjust            50 ms |██████████████████████████████   ", "deadline 100 ms", "slack",
                           "48 ms", "own 0", "machine 0", "late data 0", "mode contact", "zeta 0.25 of 1.5",
                           "lambda 0.75", "reinforcement", "acceptance 80 %", "ESS 1234", "received 11"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_THAT(text, Not(HasSubstr("DEGRADED")));
  EXPECT_THAT(text, Not(HasSubstr("old")));
}

TEST(Screen, ShowsTheProbabilitiesOfChangeAndTheRatesOfDrift) {
  WatchState state = test::SomeState();
  const std::string text = Render(state, Plain(), 1.1);
  for (const char* part : {"posterior persisted 25 %   drifted 62.5 %   changed 12.5 %   drifted, recent",
                           "drift per s", "         3.5      0.0375 "}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  state.change->p_changed[0] = 4.8e-10;
  EXPECT_THAT(Render(state, Plain(), 1.1), HasSubstr("changed 0 %"));
  EXPECT_THAT(Render(state, Plain(80, 24), 1.1), HasSubstr("drifts 0.0375 N/m^p per s"));
  state.change->n_modes = 2;
  state.change->known[1] = 1;
  test::SetText("shut", state.change->mode_name[1]);
  EXPECT_THAT(Render(state, Plain(), 1.1), HasSubstr("posterior contact      persisted 25 %"));
  EXPECT_THAT(Render(state, Plain(), 1.1), HasSubstr("posterior shut         persisted 0 %"));
  state.change->known[0] = state.change->known[1] = 0;
  EXPECT_THAT(Render(state, Plain(), 1.1), Not(HasSubstr("posterior ")));
  EXPECT_THAT(Render(state, Plain(), 1.1), Not(HasSubstr("0.0375")));
  state.change.reset();
  EXPECT_THAT(Render(state, Plain(), 1.1), Not(HasSubstr("drift")));
}

TEST(Screen, RaisesAlarmsInWordsAndInRed) {
  WatchState state = test::SomeState();
  state.status->degraded_flags = estimator_status_t::DEGRADED_NO_FIFO;
  state.status->gap_suspected = 1;
  state.status->gap_check = 2;
  state.status->gap_since_seq = 210;
  test::SetText("time_since_contact", state.status->gap_where);
  View view = Plain();
  EXPECT_THAT(Render(state, view, 1.1), HasSubstr("DEGRADED: no real-time scheduling (SCHED_FIFO)"));
  EXPECT_THAT(Render(state, view, 1.1), HasSubstr("time since contact, since pack 210"));
  view.colour = true;
  EXPECT_THAT(Render(state, view, 1.1), HasSubstr("\x1b[1;97;41m"));
}

TEST(Screen, ShowsAMiss) {
  WatchState state = test::SomeState();
  state.status->slack_ns = -2'000'000;
  state.status->missed_own = 3;
  EXPECT_THAT(Render(state, Plain(), 1.1), HasSubstr("-2 ms MISSED"));
  EXPECT_THAT(Render(state, Plain(), 1.1), HasSubstr("own 3"));
}

TEST(Screen, CallsOldWhatIsOld) {
  EXPECT_THAT(Render(test::SomeState(), Plain(), 5.0), HasSubstr("no EST_STATUS for 4 s: what is shown is old"));
}

TEST(Screen, CountsStrangers) {
  WatchState state = test::SomeState();
  state.bus.foreign = 7;
  EXPECT_THAT(Render(state, Plain(), 1.1), HasSubstr("7 messages of a foreign type"));
}

TEST(Screen, FitsEveryTerminal) {
  WatchState state = test::SomeState();
  state.estimate->n_params = 8;
  state.estimate->zeta_threshold = 0.0;
  state.status->fault_flags = 127;
  for (const int columns : {1, 20, 80, 109, 110, 300}) {
    for (const int rows : {1, 5, 24, 60}) {
      std::istringstream text(Render(state, Plain(columns, rows), 9.0));
      int lines = 0;
      for (std::string line; std::getline(text, line); ++lines) EXPECT_LE(Columns(line), columns);
      EXPECT_LE(lines, rows);
    }
  }
}

TEST(Screen, FitsATerminalOf80By24WithThreeParameters) {
  WatchState state = test::SomeState();
  state.estimate->n_params = 3;
  EXPECT_LE(Lines(state, Plain(80, 24), 1.1).size(), 24u);
  EXPECT_THAT(Render(state, Plain(80, 24), 1.1), HasSubstr("gap"));
}

TEST(Screen, NeedsNothingButAsciiWhenAsked) {
  WatchState state = test::SomeState();
  state.status->degraded_flags = 31;
  View view = Plain();
  view.glyphs = Glyphs::kAscii;
  for (const char c : Render(state, view, 9.0)) EXPECT_TRUE(c == '\n' || (c >= ' ' && c < 0x7f)) << int{c};
}

TEST(Screen, SurvivesAMessageThatMakesNoSense) {
  WatchState state = test::SomeState();
  state.estimate->n_params = 1'000'000;
  state.posterior->n_bins = -4;
  state.posterior->n_params = 1'000'000;
  state.truth->n_params = 1'000'000;
  state.status->deadline_ns = 0;
  state.estimate->plant_kind = -1;
  state.change->mode = -7;
  state.change->n_modes = state.change->n_params = 1'000'000;
  EXPECT_FALSE(Render(state, Plain(), 1.1).empty());
}

}  // namespace
}  // namespace armcmc::watch::screen_test
