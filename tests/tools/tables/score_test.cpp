#include "armcmc/tables/score.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "plants/hunt_crossley/model.hpp"
#include "plants/soft_actuator/model.hpp"

namespace armcmc::tables::score_test {
namespace {

/// 501 samples at x = 1 m at rest, so that the force is K; truth 4, 2.3, 1.7.
Recording AtRest() {
  Recording r;
  r.plant = HuntCrossley::kInfo.plant;
  r.u[0].assign(501, 1.0);
  r.u[1].assign(501, 0.0);
  r.y.assign(501, 4.1);
  r.target.assign(501, 4.0);
  r.truth[0].assign(501, 4.0);
  r.truth[1].assign(501, 2.3);
  r.truth[2].assign(501, 1.7);
  return r;
}

Trace Constant(double k) {
  Trace t{"x", "x", 100, true, true, {}};
  t.packs.resize(5);
  for (PackTrace& p : t.packs) {
    ModeTrace& mode = p.modes[0];
    mode.any = mode.known = mode.updated = true;
    mode.map = {k, 2.3, 1.7};
    mode.ap = {k + 0.1, 2.3, 1.7};
    for (auto& level : mode.interval) level = {{{k - 0.05, k + 0.05}, {2.0, 3.0}, {1.0, 1.6}}};
  }
  return t;
}

TEST(ScoreContact, ShowsAnEstimateOnePeriodAfterItsPackHasEnded) {
  const Trace trace = Constant(4.2);
  EXPECT_EQ(trace.ShownAt(199), nullptr);
  EXPECT_EQ(trace.ShownAt(200), &trace.packs[0]);
  EXPECT_EQ(trace.ShownAt(299), &trace.packs[0]);
  EXPECT_EQ(trace.ShownAt(300), &trace.packs[1]);
}

TEST(ScoreContact, CountsWhatIsShown) {
  const EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  const ContactScore s = ScoreContact(AtRest(), Constant(4.2), Point::kMap, settings);
  EXPECT_NEAR(s.mae_active_contact[0], 0.2, 1e-12);
  // 200 of 501 samples before anything is shown count as an estimate of 0.
  EXPECT_NEAR(s.mae_contact[0], (200 * 4.0 + 301 * 0.2) / 501, 1e-12);
  // Until then the force comes from the prior's mean, 2.5 N.
  EXPECT_NEAR(s.force_contact_mn, 1e3 * (200 * 1.5 + 301 * 0.2) / 501, 1e-9);
  EXPECT_NEAR(s.noisy_force_l2_n, std::sqrt(200 * 1.6 * 1.6 + 301 * 0.01), 1e-9);
  EXPECT_EQ(s.coverage[2][0], 0.0);  // [4.15, 4.25] misses 4
  EXPECT_EQ(s.coverage[2][1], 1.0);
  EXPECT_NEAR(s.width[2][0], 0.1, 1e-12);
}

TEST(ScoreContact, TakesTheMeanOfWhatIsLearntAboutDriftOverThePacksWithData) {
  Trace trace = Constant(4.2);
  for (std::size_t k = 0; k < 4; ++k) {
    trace.packs[k].modes[0].p_drifted = 0.25 * static_cast<double>(k);
    trace.packs[k].modes[0].drift_rate = {0.1 * static_cast<double>(k), 0.5, 0.0};
  }
  trace.packs[4].modes[0].updated = false;
  trace.packs[4].modes[0].p_drifted = 1.0;
  const ContactScore s = ScoreContact(AtRest(), trace, Point::kMap, BuiltinSettings("hunt_crossley"));
  EXPECT_NEAR(s.drift.share, 0.375, 1e-12);
  EXPECT_NEAR(s.drift.rate[0], 0.15, 1e-12);
  EXPECT_NEAR(s.drift.rate[1], 0.5, 1e-12);
}

TEST(ScoreContact, TellsTheTwoPointEstimatesApart) {
  const EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  const ContactScore s = ScoreContact(AtRest(), Constant(4.2), Point::kAp, settings);
  EXPECT_NEAR(s.mae_active_contact[0], 0.3, 1e-12);
}

TEST(ScoreActuator, ComparesGainAndFlow) {
  const EstimatorSettings settings = BuiltinSettings("soft_actuator");
  Recording r;
  r.plant = SoftActuator::kInfo.plant;
  r.u[0].assign(501, 1e-6);
  r.u[1].assign(501, 0.0);
  r.u[2].assign(501, ConstantOf(settings, "p_atm"));
  r.u[3].assign(501, 2.0);
  r.y.assign(501, 0.0);
  r.target.assign(501, 2.0 * 4e-4);
  r.truth[0].assign(501, 4e-4);
  r.truth[1].assign(501, 1e-9);
  Trace t{"x", "x", 100, true, true, {}};
  t.packs.resize(5);
  for (PackTrace& p : t.packs) {
    p.modes[0].any = p.modes[0].known = p.modes[0].updated = true;
    p.modes[0].map = {4.4e-4, 1e-9, 0.0};
  }
  const ActuatorScore s = ScoreActuator(r, t, Point::kMap, settings);
  EXPECT_NEAR(s.g_rel_error[0], 0.1, 1e-9);
  EXPECT_NEAR(s.theta1_l2, 4e-5 * std::sqrt(301.0), 1e-9);
  EXPECT_NEAR(s.theta2_l2, 0.0, 1e-15);
  // Nothing shown counts as no flow.
  EXPECT_NEAR(s.flow_rel_error, std::sqrt((200.0 + 301 * 0.01) / 501), 1e-9);
}

TEST(RunBatch, FindsNoiselessParameters) {
  Recording r;
  r.plant = HuntCrossley::kInfo.plant;
  for (int i = 0; i <= 500; ++i) {
    const double t = 1e-3 * i, x = 0.8 + 0.6 * std::sin(12.0 * t), v = 7.2 * std::cos(12.0 * t);
    r.u[0].push_back(x);
    r.u[1].push_back(v);
    r.y.push_back(std::pow(x, 1.7) * (4.0 + 2.3 * v));
  }
  r.target = r.y;
  const MethodSpec spec{"batch_nls", "batch", BuiltinSettings("hunt_crossley"), 100, false};
  const Trace t = RunBatch(r, spec);
  EXPECT_NEAR(t.packs[4].modes[0].map[0], 4.0, 1e-6);
  EXPECT_NEAR(t.packs[4].modes[0].map[1], 2.3, 1e-6);
  EXPECT_NEAR(t.packs[4].modes[0].map[2], 1.7, 1e-6);
}

}  // namespace
}  // namespace armcmc::tables::score_test
