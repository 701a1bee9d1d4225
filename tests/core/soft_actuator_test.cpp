#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/estimator_rig.hpp"

namespace armcmc::soft_actuator_test {
namespace {

using test::Actuator;
using test::Rig;

TEST(SoftActuator, SwitchInAPackUpdatesBothModesEachFromItsOwnSamples) {
  Rig rig(test::ActuatorSettings());
  const Actuator plant;
  const Estimate& e = rig.Step(plant.Pack(1, 60));
  EXPECT_EQ(rig.status, Status::kOk);
  EXPECT_EQ(e.mode, 1) << "the mode at the last sample";
  EXPECT_EQ(e.modes[0].num_samples, 60);
  EXPECT_EQ(e.modes[1].num_samples, 40);
  for (std::size_t m = 0; m < 2; ++m) {
    EXPECT_TRUE(e.modes[m].updated);
    test::ExpectUsable(e.modes[m], rig.estimator.settings());
    const MarginalSummary& g = e.modes[m].marginal[0];
    EXPECT_NEAR(g.ar_ap, plant.gain[m], 4.0 * g.sd) << m;
    EXPECT_LT(g.sd, 1e-5) << m;
  }
}

TEST(SoftActuator, SamplesOfOneModeDoNotTouchTheOther) {
  Rig one(test::ActuatorSettings()), other(test::ActuatorSettings());
  const DataPack pack = Actuator{}.Pack(1, 60);
  DataPack changed = pack;
  for (std::size_t n = 60; n < 100; ++n) changed.u[n][1] *= 1.7;
  const ModeEstimate a = one.Step(pack).modes[0];
  const ModeEstimate b = other.Step(changed).modes[0];
  EXPECT_EQ(std::memcmp(&a.marginal, &b.marginal, sizeof a.marginal), 0);
  EXPECT_NE(one.estimate().modes[1].marginal[0].ar_ap, other.estimate().modes[1].marginal[0].ar_ap);
}

TEST(SoftActuator, ModeIsKeptWhileTheSystemIsElsewhere) {
  Rig rig(test::ActuatorSettings());
  const Actuator plant;
  for (std::int64_t seq = 1; seq <= 5; ++seq) rig.Step(plant.Pack(seq, 100));
  const ModeEstimate learnt = rig.estimate().modes[0];
  EXPECT_FALSE(rig.estimate().modes[1].known);
  for (std::int64_t seq = 6; seq <= 10; ++seq) rig.Step(plant.Pack(seq, 0));
  EXPECT_EQ(rig.estimate().modes[0].decision, Decision::kHold);
  EXPECT_EQ(std::memcmp(&rig.estimate().modes[0].marginal, &learnt.marginal, sizeof learnt.marginal), 0);
  rig.Step(plant.Pack(11, 100));
  EXPECT_EQ(rig.estimate().modes[0].decision, Decision::kReinforcement);
  EXPECT_LT(rig.estimate().modes[0].marginal[0].sd, 1.1 * learnt.marginal[0].sd);
}

TEST(SoftActuator, ReportsTheGainAndThePaperParametersConsistently) {
  Rig rig(test::ActuatorSettings());
  for (std::int64_t seq = 1; seq <= 3; ++seq) rig.Step(Actuator{}.Pack(seq, 100));
  const auto& m = rig.estimate().modes[0].marginal;
  EXPECT_NEAR(m[2].ar_ap, m[0].ar_ap - m[1].ar_ap * ActuatorConstants{}.p_atm, 1e-12);
  EXPECT_NEAR(m[1].ar_ap, 6.12e-9, 4.0 * m[1].sd);
  EXPECT_NEAR(m[2].ar_ap, -2.14e-4, 4.0 * m[2].sd);
}

/// The posterior of packs of mode 0 in closed form, in standard deviations of the prior: where the noise is known the
/// flow is linear in g and theta2, and the prior is normal but for bounds five standard deviations away.
class LinearPosterior {
 public:
  explicit LinearPosterior(const EstimatorSettings& settings)
      : scale_(settings.parameters[0].sd, settings.parameters[1].sd),
        noise_std_(settings.noise[0].std),
        constants_(settings.constants) {}

  /// Adds a pack. @return log p(pack | packs before).
  double Add(const DataPack& pack) {
    const Eigen::Matrix2d precision_before = precision_;
    const Eigen::Vector2d mean_before = mean_;
    Eigen::Vector2d right = precision_ * mean_;
    std::vector<Eigen::Vector2d> slope;
    std::vector<double> target;
    for (std::size_t n = 0; n < static_cast<std::size_t>(pack.num_samples); ++n) {
      const auto& u = pack.u[n];
      const double rate = u[3] / noise_std_;
      slope.emplace_back(scale_[0] * rate, scale_[1] * rate * (u[2] - constants_.p_atm));
      target.push_back(u[0] * std::sqrt(constants_.p_supply - u[2]) / noise_std_);
      precision_ += slope[n] * slope[n].transpose();
      right += slope[n] * target[n];
    }
    mean_ = precision_.ldlt().solve(right);
    const Eigen::Vector2d moved = mean_ - mean_before;
    double square = moved.dot(precision_before * moved);
    for (std::size_t n = 0; n < slope.size(); ++n) square += std::pow(target[n] - slope[n].dot(mean_), 2.0);
    const double occam = std::log(precision_.determinant() / precision_before.determinant());
    return -0.5 * (square + occam) - pack.num_samples * std::log(noise_std_ * std::sqrt(2.0 * M_PI));
  }
  [[nodiscard]] double Mean(int d) const { return scale_[d] * mean_[d]; }
  [[nodiscard]] double Sd(int d) const {
    const Eigen::Matrix2d covariance = precision_.inverse();
    return scale_[d] * std::sqrt(covariance(d, d));
  }

 private:
  Eigen::Vector2d scale_;
  double noise_std_;
  ActuatorConstants constants_;
  Eigen::Matrix2d precision_ = Eigen::Matrix2d::Identity();
  Eigen::Vector2d mean_ = Eigen::Vector2d::Zero();
};

TEST(SoftActuator, EvidenceAndPosteriorOfTwoPacksEqualTheClosedForm) {
  EstimatorSettings settings = test::ActuatorSettings();
  settings.forgetting.drift_share = 0.0;
  for (NoiseSettings& noise : settings.noise) noise.estimate_std = false;
  Rig rig(settings);
  LinearPosterior exact(settings);
  for (const int seq : {1, 2}) {
    const DataPack pack = Actuator{}.Pack(seq, 100);
    const double log_evidence = exact.Add(pack);
    const ModeEstimate& e = rig.Step(pack).modes[0];
    EXPECT_EQ(e.decision, seq == 1 ? Decision::kModification : Decision::kReinforcement);
    // Some five thousand effective draws of the chain, and more by their weights; the second pack starts from a density
    // that was fitted to those of the first.
    EXPECT_NEAR(e.log_evidence, log_evidence, 0.05 * seq) << seq;
    for (int d = 0; d < 2; ++d) {
      const MarginalSummary& m = e.marginal[static_cast<std::size_t>(d)];
      const double mean = exact.Mean(d), sd = exact.Sd(d);
      EXPECT_NEAR(m.ar_ap, mean, 0.05 * seq * sd) << seq << " " << d;
      EXPECT_NEAR(m.sd / sd, 1.0, 0.06) << seq << " " << d;
      EXPECT_NEAR(m.q025, mean - 1.96 * sd, 0.1 * seq * sd) << seq << " " << d;
      EXPECT_NEAR(m.q975, mean + 1.96 * sd, 0.1 * seq * sd) << seq << " " << d;
    }
  }
}

TEST(SoftActuator, ShutValvesHoldBothModes) {
  Rig rig(test::ActuatorSettings());
  rig.Step(Actuator{}.Pack(1, 60));
  DataPack shut = Actuator{}.Pack(2, 60);
  for (auto& u : shut.u) u[0] = u[1] = 0.0;
  const Estimate& e = rig.Step(shut);
  EXPECT_EQ(rig.status, Status::kHeld);
  EXPECT_FALSE(e.active);
  EXPECT_EQ(e.mode, 2);
  EXPECT_TRUE(e.modes[0].known && e.modes[1].known);
  EXPECT_TRUE(std::isfinite(e.y_pred) && std::isfinite(e.y_free_run));
}

TEST(SoftActuator, ThetaTwoStaysWideWhenThePressureDoesNotMove) {
  EstimatorSettings settings = BuiltinSettings("soft_actuator");
  Rig rig(settings);
  const Actuator plant;
  for (std::int64_t seq = 1; seq <= 5; ++seq) {
    DataPack pack = plant.Pack(seq, 100);
    for (std::size_t n = 0; n < 100; ++n) {  // a pascal of swing, as in the paper's own data
      const double phase = 0.05 * static_cast<double>(n), over = 1.5 + 0.1 * std::sin(phase),
                   rate = 5.0 * std::cos(phase);
      pack.u[n] = {rate * (plant.gain[0] + plant.slope[0] * over) / std::sqrt(800e3 - plant.p_atm - over), 0.0,
                   plant.p_atm + over, rate};
    }
    rig.Step(pack);
  }
  const auto& m = rig.estimate().modes[0].marginal;
  EXPECT_NEAR(m[0].ar_ap / plant.gain[0], 1.0, 1e-3);
  EXPECT_GT(m[1].sd, 0.3 * settings.parameters[1].sd);
}

}  // namespace
}  // namespace armcmc::soft_actuator_test
