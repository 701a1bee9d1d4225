// The two equations of the soft actuator: what they predict, and how it moves with every coordinate.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "armcmc/gap/driven_motion.hpp"
#include "armcmc/gap/hypothesis.hpp"
#include "gap/plants/soft_actuator/actuator_signals.hpp"
#include "tools/gap/actuator_rig.hpp"

namespace armcmc::gap::test::actuator_equation_test {
namespace {

constexpr int kFlow = 0, kBend = 1;
constexpr int kWindow = 15;

std::unique_ptr<Equation> ActuatorEquation(int which) {
  return std::move(MakeEquations("soft_actuator_excited")[static_cast<std::size_t>(which)]);
}

double Rms(const Vector& v) { return std::sqrt(v.squaredNorm() / static_cast<double>(v.size())); }

/// Prediction with the true parameters of the plant.
Vector Predict(const Equation& equation, const Signals& s) {
  Vector theta = equation.Start(s);
  if (theta.size() == 4) {
    // g = theta1 + theta2 p_atm of both valves, in the units of the coordinates.
    const std::vector<Coordinate> c = equation.base(s);
    const double truth[] = {-2.14e-4 + 6.12e-9 * 101'325.0, 6.12e-9, -9.76e-5 - 1.9e-9 * 101'325.0, -1.9e-9};
    for (Eigen::Index i = 0; i < 4; ++i) theta[i] = truth[i] / c[static_cast<std::size_t>(i)].unit_size;
  }
  return Evaluate(equation, s, {}, theta).y;
}

TEST(ActuatorEquation, PredictsANoiselessPlantWithItsOwnParameters) {
  const Recording recording = RecordPlant("soft_actuator_excited", {}, 1, 4.0, false);
  for (const int which : {kFlow, kBend}) {
    const auto equation = ActuatorEquation(which);
    const Signals s = equation->Prepare(recording, kWindow);
    EXPECT_LT(Rms(Predict(*equation, s) - s.output), 1e-4 * s.output_scale) << equation->name();
  }
}

TEST(ActuatorEquation, OfANoisyPlantLeavesWhiteSensorNoiseAlone) {
  // 500 Pa/s and 0.002 rad are the scenario's; a lag-one correlation of n white samples has the sd 1 / sqrt(n).
  const Recording recording = RecordPlant("soft_actuator_excited", {}, 2, 8.0);
  const double sd[] = {500.0, 0.002};
  for (const int which : {kFlow, kBend}) {
    const auto equation = ActuatorEquation(which);
    const Signals s = equation->Prepare(recording, kWindow);
    const Vector error = s.output - Predict(*equation, s);
    const auto n = static_cast<double>(error.size());
    EXPECT_NEAR(Rms(error), sd[which], 4.0 * sd[which] / std::sqrt(2.0 * n)) << equation->name();
    const double lag = error.head(error.size() - 1).dot(error.tail(error.size() - 1)) / error.squaredNorm();
    EXPECT_LT(std::abs(lag), 4.0 / std::sqrt(n)) << equation->name();
  }
}

TEST(ActuatorEquation, MotionOfTheBendHoldsNoneOfTheNoiseThatIsToBeExplained) {
  // The flexible model is made of this motion. With a smoothed copy of the noise in it, it would explain noise.
  constexpr double kSd = 2e-3;
  const auto equation = ActuatorEquation(kBend);
  Recording recording = RecordPlant("soft_actuator_excited", {}, 8, 4.0);
  const Signals one = equation->Prepare(recording, kWindow);
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal(0.0, kSd);
  for (double& angle : recording.columns[5]) angle += normal(engine);
  const Signals other = equation->Prepare(recording, kWindow);
  const Vector apart = other.at(Role::kPosition) - one.at(Role::kPosition);
  // Smoothing alone would leave a fifth of it.
  EXPECT_LT(apart.tail(apart.size() - 500).norm() / std::sqrt(static_cast<double>(apart.size() - 500)), 0.03 * kSd);
}

TEST(ActuatorSignals, SmoothThePressureWithoutRoundingTheCornersOfTheValves) {
  const Recording clean = RecordPlant("soft_actuator_excited", {}, 3, 4.0, false);
  const Recording noisy = RecordPlant("soft_actuator_excited", {}, 3, 4.0);
  const ActuatorConstants constants = BuiltinSettings("soft_actuator_excited").constants;
  const Vector truth = clean.Column("p").array() - constants.p_atm;
  const Vector error = ActuatorSignals(noisy, kWindow, constants).at(Role::kPressure) - truth;
  EXPECT_LT(Rms(error), 12.0);  // of 50 Pa
  // At the corners themselves: every half second the valves change.
  double worst = 0.0;
  for (Eigen::Index i = 500; i < error.size() - 500; i += 500)
    worst = std::max(worst, error.segment(i - 5, 11).cwiseAbs().maxCoeff());
  EXPECT_LT(worst, 50.0);
}

TEST(DrivenMotion, IsExactForAConstantPressure) {
  // From rest: alpha = q1 p / q3 (1 + (s2 e^(s1 t) - s1 e^(s2 t)) / (s1 - s2)), s1, s2 the poles.
  const ActuatorConstants c = BuiltinSettings("soft_actuator_excited").constants;
  const double dt = 2e-3, p = 4e4;
  const Eigen::Index rows = 300;
  const Vector t = Vector::LinSpaced(rows, 0.0, dt * static_cast<double>(rows - 1));
  Vector angle(rows);
  DrivenMotion({c.q1, c.q2, c.q3}, dt).Run(t, Vector::Constant(rows, p), {}, {}, rows, &angle, nullptr);
  const double root = std::sqrt(0.25 * c.q2 * c.q2 - c.q3), s1 = -0.5 * c.q2 + root, variance = -0.5 * c.q2 - root;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double part = (variance * std::exp(s1 * t[i]) - s1 * std::exp(variance * t[i])) / (s1 - variance);
    ASSERT_NEAR(angle[i], c.q1 * p / c.q3 * (1.0 + part), 1e-12) << i;
  }
}

/// A point at which every coordinate acts, away from bounds and kinks.
Vector Somewhere(const EffectForm& form, Vector theta) {
  const Eigen::Index first = theta.size();
  theta.conservativeResize(first + form.size());
  const std::vector<double> start = form.starts.empty() ? std::vector<double>() : form.starts[form.starts.size() / 2];
  for (int c = 0; c < form.size(); ++c) {
    const Coordinate& coordinate = form.coordinates[static_cast<std::size_t>(c)];
    double value = start.empty() ? 0.0 : start[static_cast<std::size_t>(c)];
    if (c < form.num_amplitudes && value == 0.0) value = 0.005;
    if (start.empty() && c >= form.num_amplitudes) value = coordinate.prior_mean;
    theta[first + c] = std::clamp(value, coordinate.lower + 1e-3, coordinate.upper - 1e-3);
  }
  return theta;
}

TEST(DrivenMotion, RunsAbreastAreThoseOneByOneToTheBit) {
  const ActuatorConstants constants = BuiltinSettings("soft_actuator_excited").constants;
  const auto equation = ActuatorEquation(kBend);
  const Signals s = equation->Prepare(RecordPlant("soft_actuator_excited", {}, 6, 1.0), kWindow);
  const DrivenMotion simulation({constants.q1, constants.q2, constants.q3}, s.dt);
  const Vector gate = Vector::Ones(s.rows());
  std::vector<std::vector<DrivenMotion::Force>> runs(1);  // one without any force
  const std::vector<EffectForm> catalogue = equation->Catalogue(s);
  for (const EffectForm& form : catalogue) {
    if (form.slot != Slot::kForce) continue;
    const Vector at = Somewhere(form, Vector());
    std::vector<double> values;
    values.reserve(form.coordinates.size());
    for (int c = 0; c < form.size(); ++c) values.push_back(form.coordinates[static_cast<std::size_t>(c)].Value(at[c]));
    runs.push_back(runs.size() > 2 ? runs.back() : std::vector<DrivenMotion::Force>());
    if (runs.back().size() > 1) runs.back().erase(runs.back().begin());
    runs.back().push_back({&form, values, &gate});
  }
  ASSERT_GT(runs.size(), 8u);
  Matrix angles;
  simulation.RunInterleaved(s.t, s.at(Role::kPressure), {0.1, 0.2}, runs, &angles);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    Vector alone(s.rows());
    simulation.Run(s.t, s.at(Role::kPressure), {0.1, 0.2}, runs[i], s.rows(), &alone, nullptr);
    EXPECT_EQ(angles.col(static_cast<Eigen::Index>(i)), alone) << i;
    if (i > 0) {
      EXPECT_NE(angles.col(static_cast<Eigen::Index>(i)), angles.col(0)) << i;
    }
  }
}

class Derivatives : public ::testing::TestWithParam<int> {};

TEST_P(Derivatives, OfTheLawAndOfEveryFormulaAreDifferenceQuotients) {
  constexpr double kStep = 1e-4;
  const auto equation = ActuatorEquation(GetParam());
  const Signals s = equation->Prepare(RecordPlant("soft_actuator_excited", {}, 4, 1.5), kWindow);
  const std::vector<EffectForm> catalogue = equation->Catalogue(s);
  ASSERT_GE(catalogue.size(), 10u);
  for (const EffectForm& form : catalogue) {
    const Hypothesis hypothesis{{{&form, {}}}};
    const Vector theta = Somewhere(form, equation->Start(s));
    const Matrix jacobian = Evaluate(*equation, s, hypothesis, theta).jacobian;
    for (Eigen::Index c = 0; c < theta.size(); ++c) {
      Vector above = theta, below = theta;
      above[c] += kStep;
      below[c] -= kStep;
      const Vector difference =
          (Evaluate(*equation, s, hypothesis, above).y - Evaluate(*equation, s, hypothesis, below).y) / (2.0 * kStep);
      const double size = std::max(difference.norm(), 1e-9 * s.output_scale);
      // One-sided quotients of shapes differ from central ones by their step; a kink, in the sample that it passes.
      EXPECT_LT((jacobian.col(c) - difference).norm(), 0.03 * size)
          << equation->name() << ", " << form.effect << " " << form.variant << ", coordinate " << c;
    }
  }
}

TEST_P(Derivatives, AreTheSameToTheBitHoweverFewOfThemAreWanted) {
  const auto equation = ActuatorEquation(GetParam());
  const Signals s = equation->Prepare(RecordPlant("soft_actuator_excited", {}, 4, 1.5), kWindow);
  const std::vector<EffectForm> catalogue = equation->Catalogue(s);
  for (std::size_t i = 0; i + 1 < catalogue.size(); ++i) {
    // Two at a time, so that one's columns may depend on the other.
    const Hypothesis hypothesis{{{&catalogue[i], {}}, {&catalogue[i + 1], {}}}};
    const Vector theta = Somewhere(catalogue[i + 1], Somewhere(catalogue[i], equation->Start(s)));
    const Prediction all = Evaluate(*equation, s, hypothesis, theta);
    EXPECT_EQ(Evaluate(*equation, s, hypothesis, theta, Slopes::None()).y, all.y) << catalogue[i].effect;
    for (int c = 0; c < theta.size(); ++c) {
      const Prediction one = Evaluate(*equation, s, hypothesis, theta, {c, c + 1});
      EXPECT_EQ(one.y, all.y) << catalogue[i].effect << ", coordinate " << c;
      EXPECT_EQ(one.jacobian.col(c), all.jacobian.col(c)) << catalogue[i].effect << ", coordinate " << c;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Actuator, Derivatives, ::testing::Values(kFlow, kBend),
                         [](const auto& at) { return at.param == kFlow ? "flow" : "bend"; });

}  // namespace
}  // namespace armcmc::gap::test::actuator_equation_test
