#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "armcmc/expression/tape.hpp"
#include "core/estimator_rig.hpp"
#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"
#include "plants/hunt_crossley/model.hpp"

namespace armcmc::described_estimator_test {
namespace {

using Sample = test::PlantSample;
using Noise = test::GaussianNoise;
using test::DescribedPack;

TEST(DescribedEstimator, ContactIsThatOfTheBuiltInModel) {
  const auto plant = test::Program(test::DescribedContact());
  EstimatorSettings built_in = BuiltinSettings("hunt_crossley");
  test::Rig described(DescribedSettings(plant));
  test::Rig compiled(built_in);
  Noise noise(0.1);
  for (std::int64_t seq = 1; seq <= 12; ++seq) {
    DataPack pack = DescribedPack(*plant, seq, [&](double t) {
      Sample s;
      s.u[0] = 0.6 * std::sin(2.0 * t) + 0.2;
      s.u[1] = 1.2 * std::cos(2.0 * t);
      s.y = (s.u[0] >= 0.0 ? std::pow(s.u[0], 1.7) * (4.0 + 2.3 * s.u[1]) : 0.0) + noise();
      return s;
    });
    const Estimate& tape = described.Step(pack);
    pack.plant = HuntCrossley::kInfo.plant;
    const Estimate& kernel = compiled.Step(pack);
    ASSERT_EQ(described.status, compiled.status);
    EXPECT_EQ(tape.mode, kernel.mode);
    EXPECT_EQ(tape.modes[0].draws, kernel.modes[0].draws);
    EXPECT_EQ(tape.modes[0].decision, kernel.modes[0].decision) << seq;
    EXPECT_NEAR(tape.modes[0].log_evidence, kernel.modes[0].log_evidence, 1e-6) << seq;
    for (std::size_t d = 0; d < 3; ++d) {
      const MarginalSummary& a = tape.modes[0].marginal[d];
      const MarginalSummary& b = kernel.modes[0].marginal[d];
      EXPECT_NEAR(a.ar_ap, b.ar_ap, 1e-3 * (b.sd + 1e-12)) << seq << ", parameter " << d;
      EXPECT_NEAR(a.sd, b.sd, 1e-3 * b.sd) << seq << ", parameter " << d;
    }
    for (std::size_t n = 0; n < 100; ++n) EXPECT_NEAR(tape.y_shown[n], kernel.y_shown[n], 1e-3) << seq;
    EXPECT_NEAR(tape.y_pred, kernel.y_pred, 1e-3) << seq;
  }
  EXPECT_TRUE(described.estimate().modes[0].known);
}

TEST(DescribedEstimator, LinearLawAgreesWithBatchLeastSquares) {
  PlantDescription description = test::DescribedAxis();
  for (ParameterDescription& p : description.parameters) p.sd *= 100.0, p.lower = -1e5, p.upper = 1e5;
  const auto plant = test::Program(description);
  test::Rig rig(DescribedSettings(plant));
  Noise noise(1.0);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::int64_t seq = 1; seq <= 8; ++seq) {
    const DataPack pack = DescribedPack(*plant, seq, [&](double t) {
      Sample s;
      s.u[0] = 0.1 * std::sin(7.0 * t) + 0.05 * std::sin(31.0 * t);
      s.u[1] = 0.7 * std::cos(7.0 * t) + 1.55 * std::cos(31.0 * t);
      s.y = 95.0 * s.u[1] + 210.0 * s.u[0] - 3.0 + noise();
      const Eigen::Vector3d row(s.u[1], s.u[0], 1.0);
      normal += row * row.transpose();
      right += row * s.y;
      return s;
    });
    (void)rig.Step(pack);
  }
  const Eigen::Vector3d expected = normal.ldlt().solve(right);
  const Eigen::Matrix3d covariance = normal.inverse();
  for (std::size_t d = 0; d < 3; ++d) {
    const MarginalSummary& m = rig.estimate().modes[0].marginal[d];
    const auto i = static_cast<Eigen::Index>(d);
    const double sd = std::sqrt(covariance(i, i));
    EXPECT_NEAR(m.ar_ap, expected[i], 0.1 * sd) << d;
    EXPECT_NEAR(m.sd, sd, 0.1 * sd) << d;
  }
}

TEST(DescribedEstimator, LognormalParametersAreReportedAsTheyAre) {
  PlantDescription description;
  description.name = "sphere";
  description.output = "f";
  description.law = "k * max(x - x0, 0)^n + f0";
  description.signals = {{"x", "m", "position", ""}, {"f", "N", "force", ""}};
  description.parameters = {{"k", "N/m^n", "lognormal", 1.0, 4.0},
                            {"n", "1", "normal", 1.5, 0.35, 1.0, 3.0},
                            {"x0", "m", "normal", 0.0, 0.05},
                            {"f0", "N", "normal", 0.0, 0.5}};
  // The root has no value at candidates beyond the prior's bounds, which count nowhere.
  description.reports = {{"k_over_f0", "1/m^n", "k/(1 + f0)"}, {"root", "1", "sqrt(n - 1)"}};
  description.noise.std = 0.01;
  const auto plant = test::Program(description);
  test::Rig rig(DescribedSettings(plant));
  Noise noise(0.01);
  for (std::int64_t seq = 1; seq <= 15; ++seq)
    (void)rig.Step(DescribedPack(*plant, seq, [&](double t) {
      Sample s;
      s.u[0] = 0.3 + 0.35 * std::sin(9.0 * t);
      s.y = 20.0 * std::pow(std::fmax(s.u[0] - 0.02, 0.0), 1.5) + 0.1 + noise();
      return s;
    }));
  const ModeEstimate& mode = rig.estimate().modes[0];
  const double truth[] = {20.0, 1.5, 0.02, 0.1, 20.0 / 1.1, std::sqrt(0.5)};
  ASSERT_EQ(rig.estimator.num_reported(), 6);
  EXPECT_EQ(rig.estimator.reported(4).name, "k_over_f0");
  for (std::size_t r = 0; r < 6; ++r)
    EXPECT_NEAR(mode.marginal[r].ar_ap, truth[r], 4.0 * mode.marginal[r].sd)
        << rig.estimator.reported(static_cast<int>(r)).name;
  EXPECT_LT(mode.marginal[0].sd, 1.0);
  // What is shown is computed with k, not with its logarithm or that of something else.
  for (std::size_t n = 0; n < 100; ++n) EXPECT_NEAR(rig.estimate().y_shown[n], rig.result->pack.y[n], 0.06);
}

TEST(DescribedEstimator, ModesThatShareAParameterAreSampledTogether) {
  PlantDescription description;
  description.name = "stroke";
  description.output = "F";
  description.signals = {{"v", "m/s", "velocity", ""}, {"a", "m/s^2", "acceleration", ""}, {"F", "N", "force", ""}};
  description.parameters = {{"M", "kg", "normal", 5.0, 5.0}, {"Fc", "N", "normal", 0.0, 10.0}};
  description.parameters[1].per_mode = true;
  description.modes = {{"forward", "v > 0", "M*a + Fc", "", false}, {"back", "", "M*a - Fc", "", false}};
  description.noise.std = 0.1;
  const auto plant = test::Program(description);
  EXPECT_EQ(plant->info().num_modes, 1);
  ASSERT_EQ(plant->info().num_parameters, 3);
  EXPECT_EQ(plant->info().parameters[1].name, "Fc_forward");
  EXPECT_EQ(plant->info().parameters[2].name, "Fc_back");
  test::Rig rig(DescribedSettings(plant));
  Noise noise(0.1);
  for (std::int64_t seq = 1; seq <= 10; ++seq)
    (void)rig.Step(DescribedPack(*plant, seq, [&](double t) {
      Sample s;
      s.u[0] = std::sin(40.0 * t);
      s.u[1] = 40.0 * std::cos(40.0 * t);
      s.y = 3.0 * s.u[1] + (s.u[0] > 0.0 ? 2.0 : -4.0) + noise();
      return s;
    }));
  const ModeEstimate& mode = rig.estimate().modes[0];
  EXPECT_NEAR(mode.marginal[0].ar_ap, 3.0, 4.0 * mode.marginal[0].sd);
  EXPECT_NEAR(mode.marginal[1].ar_ap, 2.0, 4.0 * mode.marginal[1].sd);
  EXPECT_NEAR(mode.marginal[2].ar_ap, 4.0, 4.0 * mode.marginal[2].sd);
  EXPECT_LT(mode.marginal[1].sd, 0.05);
}

TEST(DescribedEstimator, ModesOfTheirOwnAreSampledApart) {
  PlantDescription description;
  description.name = "valve";
  description.output = "F";
  description.signals = {{"u", "1", "drive", ""}, {"F", "N", "force", ""}};
  description.parameters = {{"g", "N", "normal", 0.0, 10.0}};
  description.parameters[0].per_mode = true;
  description.modes = {
      {"in", "u > 0", "g*u", "", false}, {"out", "u < 0", "g*u", "", false}, {"shut", "", "7", "", true}};
  description.noise.std = 0.1;
  const auto plant = test::Program(description);
  test::Rig rig(DescribedSettings(plant));
  Noise noise(0.1);
  for (std::int64_t seq = 1; seq <= 9; ++seq)
    (void)rig.Step(DescribedPack(*plant, seq, [&](double t) {
      Sample s;
      s.u[0] = seq % 3 == 1 ? 1.0 + std::sin(50.0 * t) * 0.5 : seq % 3 == 2 ? -1.0 : 0.0;
      s.y = (s.u[0] > 0.0 ? 3.0 : 5.0) * s.u[0] + noise();
      return s;
    }));
  const Estimate& estimate = rig.estimate();
  EXPECT_EQ(estimate.num_modes, 2);
  EXPECT_EQ(estimate.mode, 2);
  EXPECT_EQ(rig.estimator.mode_name(2), "shut");
  EXPECT_NEAR(estimate.modes[0].marginal[0].ar_ap, 3.0, 4.0 * estimate.modes[0].marginal[0].sd);
  EXPECT_NEAR(estimate.modes[1].marginal[0].ar_ap, 5.0, 4.0 * estimate.modes[1].marginal[0].sd);
  EXPECT_EQ(estimate.y_pred, 7.0) << "what the passive mode shows";
  for (std::size_t n = 0; n < 100; ++n) EXPECT_EQ(estimate.y_shown[n], 7.0);
}

TEST(DescribedEstimator, ALawThatExplainsSomethingElsePredictsNoOutput) {
  PlantDescription description;
  description.name = "flow";
  description.output = "F";
  description.signals = {{"u", "m", "", ""}, {"F", "N", "force", ""}};
  description.parameters = {{"g", "1", "normal", 0.0, 10.0}};
  description.modes = {{"only", "", "g*u", "2*u", false}};
  description.noise.std = 0.1;
  const auto plant = test::Program(description);
  EXPECT_EQ(plant->info().target_unit, "m");
  test::Rig rig(DescribedSettings(plant));
  for (std::int64_t seq = 1; seq <= 3; ++seq)
    (void)rig.Step(DescribedPack(*plant, seq, [](double t) {
      Sample s;
      s.u[0] = 1.0 + t;
      s.y = 50.0;
      return s;
    }));
  EXPECT_NEAR(rig.estimate().modes[0].marginal[0].ar_ap, 2.0, 0.05);
  EXPECT_TRUE(std::isnan(rig.estimate().y_pred)) << "metres are no newtons";
  EXPECT_TRUE(std::isnan(rig.estimate().y_shown[0]));
}

TEST(DescribedEstimator, MemoryGoesOnFromPackToPack) {
  PlantDescription description = test::DescribedAxis();
  description.law = "M*lowpass(a, 0.05) + Fv*previous(v) + off";
  const auto plant = test::Program(description);
  test::Rig rig(DescribedSettings(plant));
  Noise noise(1.0);
  double filtered = 0.0;
  double before = 0.0;
  double a_before = 0.0;
  bool first = true;
  for (std::int64_t seq = 1; seq <= 12; ++seq)
    (void)rig.Step(DescribedPack(*plant, seq, [&](double t) {
      Sample s;
      s.u[0] = 0.4 * std::sin(25.0 * t);
      s.u[1] = 10.0 * std::cos(25.0 * t);
      const double decay = std::exp(-1e-3 / 0.05);
      const double mean = (1.0 - decay) * 0.05 / 1e-3;
      filtered = first ? s.u[1] : filtered * decay + a_before * (mean - decay) + s.u[1] * (1.0 - mean);
      s.y = 95.0 * filtered + 210.0 * (first ? s.u[0] : before) + noise();
      before = s.u[0];
      a_before = s.u[1];
      first = false;
      return s;
    }));
  const ModeEstimate& mode = rig.estimate().modes[0];
  EXPECT_NEAR(mode.marginal[0].ar_ap, 95.0, 4.0 * mode.marginal[0].sd);
  EXPECT_NEAR(mode.marginal[1].ar_ap, 210.0, 4.0 * mode.marginal[1].sd);
  EXPECT_LT(mode.marginal[0].sd, 0.1);
}

TEST(DescribedEstimator, PacksOfAnotherPlantAreRejected) {
  const auto plant = test::Program(test::DescribedAxis());
  test::Rig rig(DescribedSettings(plant));
  const auto blank = [&] { return DescribedPack(*plant, 1, [](double) { return Sample{}; }); };
  DataPack pack = blank();
  pack.fingerprint ^= 1;
  (void)rig.Step(pack);
  EXPECT_EQ(rig.status, Status::kBadPack);
  pack = blank();
  pack.plant = HuntCrossley::kInfo.plant;
  (void)rig.Step(pack);
  EXPECT_EQ(rig.status, Status::kBadPack);
  pack = blank();
  pack.num_inputs = 1;
  (void)rig.Step(pack);
  EXPECT_EQ(rig.status, Status::kBadPack);
  (void)rig.Step(blank());
  EXPECT_NE(rig.status, Status::kBadPack);
}

TEST(DescribedEstimator, SnapshotGoesOnToTheBit) {
  const auto plant = test::Program(test::DescribedAxis());
  const EstimatorSettings settings = DescribedSettings(plant);
  Noise noise(1.0);
  const auto pack = [&](std::int64_t seq) {
    return DescribedPack(*plant, seq, [&](double t) {
      Sample s;
      s.u = {std::sin(20.0 * t), 20.0 * std::cos(20.0 * t)};
      s.y = 90.0 * s.u[1] + 200.0 * s.u[0] + noise();
      return s;
    });
  };
  test::Rig first(settings);
  for (std::int64_t seq = 1; seq <= 4; ++seq) (void)first.Step(pack(seq));
  std::vector<std::byte> adjusted(Estimator::kSnapshotBytes);
  std::vector<std::byte> executed(Estimator::kSnapshotBytes);
  adjusted.resize(first.estimator.SaveAdjusted(adjusted));
  executed.resize(first.estimator.SaveExecuted(executed));
  ASSERT_FALSE(adjusted.empty() || executed.empty());
  test::Rig second(settings);
  ASSERT_TRUE(second.estimator.Restore(adjusted, executed));
  const DataPack next = pack(5);
  test::ExpectSameBits(first.Step(next), second.Step(next));
}

TEST(DescribedEstimator, SettingsThatDoNotFitAreErrors) {
  const auto plant = test::Program(test::DescribedAxis());
  EstimatorSettings settings = DescribedSettings(plant);
  settings.num_effects = 1;
  EXPECT_THROW(settings.Validate(), std::invalid_argument);
  settings = DescribedSettings(plant);
  settings.parameters[0].name = "K";
  EXPECT_THROW(settings.Validate(), std::invalid_argument);
}

TEST(PlantProgram, LimitsAreErrorsThatNameTheirKey) {
  const auto key_of = [](PlantDescription description) -> std::string {
    try {
      (void)test::Program(std::move(description));
    } catch (const PlantError& error) {
      return error.key();
    }
    return "";
  };
  PlantDescription many = test::DescribedAxis();
  many.law = "M*a + Fv*v + off";
  for (int k = 0; k < 6; ++k) {
    many.parameters.push_back({"c" + std::to_string(k), "N", "normal", 0.0, 1.0});
    many.law += " + c" + std::to_string(k) + "*step(v - " + std::to_string(k + 1) + ")";
  }
  EXPECT_EQ(key_of(many), "parameters");
  PlantDescription named = test::DescribedAxis();
  named.name = std::string(31, 'a');
  EXPECT_EQ(key_of(named), "");
  named.name += 'a';
  EXPECT_EQ(key_of(named), "name");
  PlantDescription memory = test::DescribedAxis();
  memory.law = "delay(integral(M*a), 0.1) + Fv*v + off";
  memory.signals[1] = {"a", "m/s^3", "", ""};
  EXPECT_EQ(key_of(memory), "law");
  PlantDescription states = test::DescribedAxis();
  states.states = {{"s", "m/s", "", "a", "v", "", 100}};
  states.law = "M*a + Fv*s + off";
  EXPECT_EQ(key_of(states), "");
  states.states[0].rate = "M/(2*M)*a + M/(3*M)*abs(a) + M/(4*M)*max(a, 0) + M/(5*M)*min(a, 0) + M/(6*M)*a*step(a - 1)";
  EXPECT_EQ(key_of(states), "states") << "too many substeps";
}

}  // namespace
}  // namespace armcmc::described_estimator_test
