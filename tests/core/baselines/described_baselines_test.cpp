#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <functional>
#include <vector>

#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"
#include "support/alloc_counter.hpp"

namespace armcmc::described_baselines_test {
namespace {

using test::DescribedPack;
using test::PlantSample;

/// An axis whose prior says next to nothing.
PlantDescription WideAxis() {
  PlantDescription plant = test::DescribedAxis();
  for (ParameterDescription& p : plant.parameters) p.sd *= 1000.0, p.lower = -1e6, p.upper = 1e6;
  return plant;
}

std::vector<DataPack> AxisPacks(const PlantProgram& plant, std::int64_t count) {
  test::GaussianNoise noise(1.0);
  std::vector<DataPack> packs;
  for (std::int64_t seq = 1; seq <= count; ++seq)
    packs.push_back(DescribedPack(plant, seq, [&](double t) {
      PlantSample s;
      s.u[0] = 0.1 * std::sin(7.0 * t) + 0.05 * std::sin(31.0 * t);
      s.u[1] = 0.7 * std::cos(7.0 * t) + 1.55 * std::cos(31.0 * t);
      s.y = 95.0 * s.u[1] + 210.0 * s.u[0] - 3.0 + noise();
      return s;
    }));
  return packs;
}

struct LeastSquares {
  Eigen::VectorXd estimate, sd;
};

/// Of all packs at once, noise 1. @param row  Regressors of a sample.
template <class Row>
LeastSquares Batch(const std::vector<DataPack>& packs, Eigen::Index parameters, const Row& row) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(parameters, parameters);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(parameters);
  for (const DataPack& pack : packs)
    for (std::size_t n = 0; n < static_cast<std::size_t>(pack.num_samples); ++n) {
      const Eigen::VectorXd x = row(pack.u[n]);
      normal += x * x.transpose();
      right += x * pack.y[n];
    }
  return {normal.ldlt().solve(right), normal.inverse().diagonal().cwiseSqrt()};
}

LeastSquares BatchOfAxis(const std::vector<DataPack>& packs) {
  return Batch(packs, 3, [](const auto& u) { return Eigen::Vector3d(u[1], u[0], 1.0); });
}

EstimatorSettings With(Method method, const std::shared_ptr<const PlantProgram>& plant) {
  EstimatorSettings settings = DescribedSettings(plant);
  settings.method = method;
  settings.baseline.rls_forgetting = 1.0;
  settings.baseline.pf_jitter = 0.0;
  return settings;
}

TEST(DescribedRls, IsBatchLeastSquaresWhereTheLawIsLinear) {
  const auto plant = test::Program(WideAxis());
  test::Rig rig(With(Method::kRls, plant));
  const std::vector<DataPack> packs = AxisPacks(*plant, 8);
  for (const DataPack& pack : packs) {
    (void)rig.Step(pack);
    ASSERT_EQ(rig.status, Status::kOk);
  }
  const LeastSquares expected = BatchOfAxis(packs);
  const ModeEstimate& mode = rig.estimate().modes[0];
  EXPECT_TRUE(mode.known);
  for (std::size_t d = 0; d < 3; ++d) {
    const auto i = static_cast<Eigen::Index>(d);
    EXPECT_NEAR(mode.marginal[d].ar_map, expected.estimate[i], 1e-3 * expected.sd[i]) << d;
    EXPECT_NEAR(mode.marginal[d].sd, expected.sd[i], 0.1 * expected.sd[i]) << "as far as 2048 draws tell, " << d;
  }
}

TEST(DescribedRls, FollowsWhatChangesWhereItForgets) {
  const auto plant = test::Program(WideAxis());
  EstimatorSettings settings = With(Method::kRls, plant);
  settings.baseline.rls_forgetting = 0.99;
  test::Rig rig(settings);
  std::vector<DataPack> packs = AxisPacks(*plant, 16);
  for (std::size_t k = 0; k < packs.size(); ++k) {
    for (std::size_t n = 0; k >= 8 && n < 100; ++n) packs[k].y[n] += 40.0 * packs[k].u[n][1];
    (void)rig.Step(packs[k]);
  }
  EXPECT_NEAR(rig.estimate().modes[0].marginal[0].ar_map, 135.0, 2.0);
}

TEST(DescribedRls, IsLinearisedWhereTheLawIsNot) {
  const auto plant = test::Program(test::DescribedContact());
  test::Rig rls(With(Method::kRls, plant)), armcmc(With(Method::kArmcmc, plant));
  test::GaussianNoise noise(0.1);
  for (std::int64_t seq = 1; seq <= 10; ++seq) {
    const DataPack pack = DescribedPack(*plant, seq, [&](double t) {
      PlantSample s;
      s.u[0] = 1.0 + 0.5 * std::sin(25.0 * t);
      s.u[1] = 12.5 * std::cos(25.0 * t) * 0.1;
      s.y = std::pow(s.u[0], 1.7) * (4.0 + 2.3 * s.u[1]) + noise();
      return s;
    });
    (void)rls.Step(pack);
    (void)armcmc.Step(pack);
  }
  for (std::size_t d = 0; d < 3; ++d) {
    const MarginalSummary& found = rls.estimate().modes[0].marginal[d];
    const MarginalSummary& reference = armcmc.estimate().modes[0].marginal[d];
    EXPECT_NEAR(found.ar_map, reference.ar_ap, reference.sd) << d;
    EXPECT_NEAR(found.sd, reference.sd, 0.3 * reference.sd) << d;
  }
}

/// What is measured of a vessel that is filled and leaks: y' = b u - a y, noise 0.01.
std::vector<DataPack> VesselPacks(const PlantProgram& plant, std::int64_t count) {
  constexpr double kDt = 0.01;
  test::GaussianNoise noise(0.01);
  std::vector<DataPack> packs;
  double y = 0.4;
  for (std::int64_t seq = 1; seq <= count; ++seq)
    packs.push_back(DescribedPack(
        plant, seq,
        [&](double t) {
          constexpr int kFine = 50;
          const PlantSample sample{{1.0 + std::sin(9.0 * t)}, y + noise()};
          for (int i = 0; i < kFine; ++i)
            y += kDt / kFine * (3.0 * (1.0 + std::sin(9.0 * (t + (i + 0.5) * kDt / kFine))) - 2.0 * y);
          return sample;
        },
        100, kDt));
  return packs;
}

class DescribedBaseline : public ::testing::TestWithParam<Method> {};

TEST_P(DescribedBaseline, AgreesWithLeastSquaresOfALinearLaw) {
  PlantDescription description = test::DescribedAxis();
  const auto plant = test::Program(description);
  test::Rig rig(With(GetParam(), plant));
  const std::vector<DataPack> packs = AxisPacks(*plant, 8);
  for (const DataPack& pack : packs) (void)rig.Step(pack);
  const LeastSquares expected = BatchOfAxis(packs);
  for (std::size_t d = 0; d < 3; ++d) {
    const auto i = static_cast<Eigen::Index>(d);
    EXPECT_NEAR(rig.estimate().modes[0].marginal[d].ar_ap, expected.estimate[i], 1.5 * expected.sd[i]) << d;
    EXPECT_LT(rig.estimate().modes[0].marginal[d].sd, 2.0 * expected.sd[i]) << d;
  }
}

TEST_P(DescribedBaseline, FindsWhatMovesAState) {
  const auto plant = test::Program(test::LeakyVessel());
  test::Rig rig(With(GetParam(), plant));
  for (const DataPack& pack : VesselPacks(*plant, 6)) {
    (void)rig.Step(pack);
    ASSERT_EQ(rig.status, Status::kOk);
  }
  const ModeEstimate& mode = rig.estimate().modes[0];
  EXPECT_NEAR(mode.marginal[0].ar_ap, 2.0, 0.03);
  EXPECT_NEAR(mode.marginal[1].ar_ap, 3.0, 0.03);
  EXPECT_LT(mode.marginal[0].sd, 0.02);
}

TEST_P(DescribedBaseline, DoesNotAllocateInAStep) {
  const auto plant = test::Program(test::LeakyVessel());
  test::Rig rig(With(GetParam(), plant));
  const std::vector<DataPack> packs = VesselPacks(*plant, 3);
  (void)rig.Step(packs[0]);
  (void)rig.Step(packs[1]);
  long count = -1;
  {
    const test::AllocCounter guard;
    (void)rig.Step(packs[2]);
    count = guard.count();
  }
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  EXPECT_EQ(count, 0);
}

INSTANTIATE_TEST_SUITE_P(All, DescribedBaseline, ::testing::Values(Method::kRls, Method::kParticleFilter),
                         [](const auto& m) { return m.param == Method::kRls ? "Rls" : "ParticleFilter"; });

}  // namespace
}  // namespace armcmc::described_baselines_test
