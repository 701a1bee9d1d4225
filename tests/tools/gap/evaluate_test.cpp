// Exact derivatives of every hypothesis against central differences.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "armcmc/gap/hypothesis.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::evaluate_test {
namespace {

using test::Bench;

constexpr double kStep = 1e-6;
// Of the norm of a column. Shapes and latencies are differentiated by a one-sided quotient on purpose.
constexpr double kTolerance = 3e-4;

/// A value inside the bounds where every derivative lives.
double Inside(const Coordinate& c, const EffectForm& form) {
  if (form.effect == "sensor_saturation") return 0.517;
  if (form.effect == "a dead zone of the sensor") return 0.0631;
  if (form.family == "latency") return 0.4137;
  const double low = std::max(c.lower, c.prior_mean - 2.0 * c.prior_sd);
  const double high = std::min(c.upper, c.prior_mean + 2.0 * c.prior_sd);
  return low + 0.631 * (high - low);
}

Vector PointFor(const Hypothesis& hypothesis) {
  std::vector<double> theta{0.93, 0.21, 1.63};
  for (const Term& term : hypothesis.terms)
    for (const Coordinate& c : term.form->coordinates) theta.push_back(Inside(c, *term.form));
  return Eigen::Map<Vector>(theta.data(), static_cast<Eigen::Index>(theta.size()));
}

std::string Words(const Hypothesis& hypothesis) {
  std::string words;
  for (const Term& term : hypothesis.terms) words += TermText(term) + " (" + term.form->variant + ") ";
  return words;
}

void ExpectExact(const Bench& bench, const Hypothesis& hypothesis) {
  const Vector theta = PointFor(hypothesis);
  const Prediction at = Evaluate(*bench.equation, bench.signals, hypothesis, theta);
  ASSERT_TRUE(at.y.allFinite()) << Words(hypothesis);
  ASSERT_TRUE(at.jacobian.allFinite()) << Words(hypothesis);
  for (Eigen::Index c = 0; c < theta.size(); ++c) {
    Vector up = theta, down = theta;
    up[c] += kStep;
    down[c] -= kStep;
    const Vector slope = (Evaluate(*bench.equation, bench.signals, hypothesis, up).y -
                          Evaluate(*bench.equation, bench.signals, hypothesis, down).y) /
                         (2.0 * kStep);
    const double size = std::max(slope.norm(), 1e-3 * at.y.norm());
    EXPECT_LT((at.jacobian.col(c) - slope).norm(), kTolerance * size) << Words(hypothesis) << "coordinate " << c;
    // Every coordinate moves the prediction, else the comparison says nothing; a gate may shut it out.
    const bool open = std::all_of(hypothesis.terms.begin(), hypothesis.terms.end(),
                                  [](const Term& term) { return term.when.kind == When::Kind::kAlways; });
    if (open && hypothesis.terms.size() <= 1) {
      EXPECT_GT(slope.norm(), 1e-6 * at.y.norm()) << Words(hypothesis) << c;
    }
  }
}

class EvaluateTest : public ::testing::Test {
 protected:
  const Bench bench_{test::Measure({}, 1500, 0.0, 1).recording};
};

TEST_F(EvaluateTest, BaseLawIsHuntAndCrossleys) {
  const Signals& s = bench_.signals;
  const Vector theta{{0.93, 0.21, 1.63}};
  const auto reported = bench_.equation->Report(s, theta, Matrix::Zero(3, 3));
  const Vector y = Evaluate(*bench_.equation, s, {}, theta).y;
  for (Eigen::Index i = 0; i < s.rows(); ++i) {
    const double x = s.at(Role::kPosition)[i], v = s.at(Role::kVelocity)[i];
    const double force = x > 0.0 ? std::pow(x, reported[2].mean) * (reported[0].mean + reported[1].mean * v) : 0.0;
    ASSERT_NEAR(y[i], force, 1e-12 * s.output_scale);
  }
}

TEST_F(EvaluateTest, EveryFormAlone) {
  EXPECT_GE(bench_.catalogue.size(), 14u);
  for (const EffectForm& form : bench_.catalogue) ExpectExact(bench_, {{{&form, {}}}});
}

TEST_F(EvaluateTest, EveryFormGated) {
  for (const EffectForm& form : bench_.catalogue)
    for (const When::Kind kind : {When::Kind::kContact, When::Kind::kFree, When::Kind::kFrom, When::Kind::kUntil})
      ExpectExact(bench_, {{{&form, {kind, 0.7505}}}});
}

TEST_F(EvaluateTest, GatesOpenAndShutAtTheirSample) {
  const Signals& s = bench_.signals;
  const Vector from = GateOf({When::Kind::kFrom, s.t[700]}, s), until = GateOf({When::Kind::kUntil, s.t[700]}, s);
  EXPECT_EQ(from[699], 0.0);
  EXPECT_EQ(from[700], 1.0);
  EXPECT_EQ(until[699], 1.0);
  EXPECT_EQ(until[700], 0.0);
  const Vector modes = GateOf({When::Kind::kContact, 0.0}, s) + GateOf({When::Kind::kFree, 0.0}, s);
  EXPECT_EQ(modes, Vector::Ones(s.rows()));
}

TEST_F(EvaluateTest, AShutGateIsTheBaseLaw) {
  const Vector base = Evaluate(*bench_.equation, bench_.signals, {}, PointFor({})).y;
  for (const EffectForm& form : bench_.catalogue) {
    const Hypothesis hypothesis{{{&form, {When::Kind::kFrom, 1e6}}}};
    const Prediction p = Evaluate(*bench_.equation, bench_.signals, hypothesis, PointFor(hypothesis));
    EXPECT_LT((p.y - base).cwiseAbs().maxCoeff(), 1e-14) << form.effect << form.variant;
    EXPECT_TRUE(p.jacobian.rightCols(form.size()).isZero(0.0)) << form.effect << form.variant;
  }
}

TEST_F(EvaluateTest, PairsAcrossSlotsInBothOrders) {
  const Bench small{test::Measure({}, 700, 0.0, 1).recording};
  std::vector<const EffectForm*> forms;
  for (const EffectForm& form : small.catalogue)
    if (form.exact() || form.slot == Slot::kMemory || form.variant == "soft") forms.push_back(&form);
  for (const EffectForm* a : forms)
    for (const EffectForm* b : forms)
      if (a->effect != b->effect && (a < b || a->slot != b->slot)) ExpectExact(small, {{{a, {}}, {b, {}}}});
}

TEST_F(EvaluateTest, APairOfGatedTermsOfDifferentSlots) {
  const auto& form = [&](const char* name) -> const EffectForm& { return bench_.Form(name); };
  const When late{When::Kind::kFrom, 0.6}, early{When::Kind::kUntil, 0.9}, touching{When::Kind::kContact, 0.0};
  ExpectExact(bench_, {{{&form("contact_offset"), late}, {&form("sensor_lag"), early}}});
  ExpectExact(bench_, {{{&form("stiffness_drift"), early}, {&form("sensor_delay"), late}}});
  ExpectExact(bench_, {{{&form("coulomb_friction"), touching}, {&form("sensor_saturation"), late}}});
  ExpectExact(bench_, {{{&bench_.Form("stress_relaxation", "elastic"), early}, {&form("stiffness_drift"), late}}});
}

TEST_F(EvaluateTest, OrderOfTermsDoesNotMatterToThePrediction) {
  const EffectForm& lag = bench_.Form("sensor_lag");
  const EffectForm& bias = bench_.Form("force_bias");
  const Vector ab{{0.93, 0.21, 1.63, 0.4, 0.1}}, ba{{0.93, 0.21, 1.63, 0.1, 0.4}};
  const Vector first = Evaluate(*bench_.equation, bench_.signals, {{{&lag, {}}, {&bias, {}}}}, ab).y;
  const Vector second = Evaluate(*bench_.equation, bench_.signals, {{{&bias, {}}, {&lag, {}}}}, ba).y;
  EXPECT_TRUE(first.isApprox(second, 1e-14));
}

// The slope by a frequency grows with time: it must hold on long recordings and at high frequencies, too.
TEST(EvaluateLong, SlopeByAFrequencyHoldsOnALongRecording) {
  const Bench bench{test::Measure({}, 20'000, 0.0, 1).recording};
  const EffectForm& wave = bench.Form("periodic_disturbance");
  const Hypothesis hypothesis{{{&wave, {}}}};
  Vector theta{{0.93, 0.21, 1.63, 0.1, 0.05, std::log(120.0)}};
  const Prediction at = Evaluate(*bench.equation, bench.signals, hypothesis, theta);
  Vector up = theta, down = theta;
  up[5] += 1e-8;
  down[5] -= 1e-8;
  const Vector slope = (Evaluate(*bench.equation, bench.signals, hypothesis, up).y -
                        Evaluate(*bench.equation, bench.signals, hypothesis, down).y) /
                       2e-8;
  EXPECT_LT((at.jacobian.col(5) - slope).norm(), 0.02 * slope.norm());
}

TEST(Evaluate, ColumnsAreTheSameToTheBitHoweverFewOfThemAreWanted) {
  const Bench bench(test::Measure({}, 600, 0.01, 3).recording);
  const EffectForm& lag = bench.Form("sensor_lag");
  const EffectForm& relaxation = bench.Form("stress_relaxation");
  for (const EffectForm& form : bench.catalogue) {
    Hypothesis hypothesis{{{&form, {}}}};
    if (form.effect != relaxation.effect) hypothesis.terms.push_back({&relaxation, {}});
    if (form.effect != lag.effect) hypothesis.terms.push_back({&lag, {When::Kind::kFrom, 0.2}});
    const Vector theta = PointFor(hypothesis);
    const Prediction all = Evaluate(*bench.equation, bench.signals, hypothesis, theta);
    EXPECT_EQ(Evaluate(*bench.equation, bench.signals, hypothesis, theta, Slopes::None()).y, all.y) << form.effect;
    for (int c = 0; c < theta.size(); ++c) {
      const Prediction one = Evaluate(*bench.equation, bench.signals, hypothesis, theta, {c, c + 1});
      EXPECT_EQ(one.y, all.y) << Words(hypothesis) << "coordinate " << c;
      EXPECT_EQ(one.jacobian.col(c), all.jacobian.col(c)) << Words(hypothesis) << "coordinate " << c;
    }
  }
}

TEST(Evaluate, ALatencyIsTheSameTimeInARecordingOfAnotherRate) {
  const Bench slow(test::Measure({}, 1000, 0.0, 3, 1e-3).recording);
  const Recording quick = test::Measure({}, 4000, 0.0, 3, 0.25e-3).recording;
  const Signals fine = slow.equation->PrepareLike(quick, 15, slow.signals);
  constexpr double kLatency_s = 4e-3;
  for (const char* effect : {"sensor_delay", "sensor_lag"}) {
    const EffectForm& form = slow.Form(effect);
    const Hypothesis hypothesis{{{&form, {}}}};
    Vector theta = PointFor(hypothesis);
    theta[3] = kLatency_s / form.coordinates[0].unit_size;
    const Vector at_slow = Evaluate(*slow.equation, slow.signals, hypothesis, theta).y;
    const Vector at_fine = Evaluate(*slow.equation, fine, hypothesis, theta).y;
    const Vector without = Evaluate(*slow.equation, slow.signals, {}, theta.head(3)).y;
    double worst = 0.0;
    for (Eigen::Index i = 100; i < 990; ++i) worst = std::max(worst, std::abs(at_slow[i] - at_fine[4 * i]));
    const double moved = (at_slow - without).segment(100, 890).cwiseAbs().maxCoeff();
    EXPECT_LT(worst, 0.02 * moved) << effect;
  }
}

}  // namespace
}  // namespace armcmc::gap::evaluate_test
