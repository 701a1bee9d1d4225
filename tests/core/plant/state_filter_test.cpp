// What is known of a plant's states from pack to pack, and what that makes of its parameters.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/plant/described_packs.hpp"
#include "core/plant/oscillator.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::state_filter_test {
namespace {

using test::DescribedPack;
using test::Drive;
using test::kDt;
using test::Oscillator;
using test::PlantSample;
using test::Reference;

constexpr double kNoise = 0.002;
constexpr std::size_t kParameters = 3;

struct Run {
  int packs, samples;
  double speed = 0.0;  ///< At the first sample, which the plant file takes for 0.
  unsigned seed = 11;
};

/// The posterior after a run of the oscillator.
ModeEstimate PosteriorAfter(const Run& run) {
  const auto plant = test::Program(Oscillator());
  test::Rig rig(DescribedSettings(plant));
  test::GaussianNoise noise(kNoise);
  for (unsigned skip = 0; skip < 1000 * run.seed; ++skip) (void)noise();
  Reference reference;
  reference.x = {0.2, run.speed};
  double t_before = kDt;
  for (std::int64_t seq = 1; seq <= run.packs; ++seq) {
    (void)rig.Step(DescribedPack(
        *plant, seq,
        [&](double t) {
          if (t > t_before + 0.5 * kDt) reference.Step(Drive(t_before), Drive(t));
          t_before = t;
          return PlantSample{{Drive(t)}, reference.x[0] + noise()};
        },
        run.samples, kDt));
    EXPECT_EQ(rig.status, Status::kOk) << seq;
  }
  return rig.estimate().modes[0];
}

double Distance(const ModeEstimate& mode, std::size_t d) {
  return (mode.marginal[d].ar_ap - Reference().theta[d]) / mode.marginal[d].sd;
}

TEST(StateFilter, EstimatorLearnsWhatMovesThemAndGoesOnFromPackToPack) {
  const auto plant = test::Program(Oscillator());
  test::Rig rig(DescribedSettings(plant));
  test::ReferenceRun run;
  std::vector<double> errors;
  for (std::int64_t seq = 1; seq <= 12; ++seq) {
    (void)rig.Step(DescribedPack(
        *plant, seq, [&](double t) { return run.At(t); }, 50, kDt));
    ASSERT_EQ(rig.status, Status::kOk) << seq;
    if (seq < 6) continue;
    for (std::size_t n = 0; n < 50; ++n) errors.push_back(rig.estimate().y_shown[n] - rig.result->pack.y[n]);
  }
  const ModeEstimate& mode = rig.estimate().modes[0];
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(mode.marginal[d].ar_ap, run.reference.theta[d], 5.0 * mode.marginal[d].sd) << d;
    EXPECT_LT(mode.marginal[d].sd, 0.02 * run.reference.theta[d]) << d;
  }
  double square = 0.0;
  for (const double e : errors) square += e * e;
  EXPECT_LT(std::sqrt(square / static_cast<double>(errors.size())), 0.004) << "of what is shown, noise included";
}

// Where a pack ends says something of the parameters, which the next one has to take up: else each begins anew.
TEST(StateFilter, SixPacksTellWhatOneOfAllTheirSamplesDoes) {
  const ModeEstimate one = PosteriorAfter({1, 240}), six = PosteriorAfter({6, 40});
  for (std::size_t d = 0; d < kParameters; ++d) {
    EXPECT_NEAR(six.marginal[d].ar_ap, one.marginal[d].ar_ap, 1.5 * one.marginal[d].sd) << d;
    EXPECT_LT(six.marginal[d].sd, 1.8 * one.marginal[d].sd) << d;
    EXPECT_GT(six.marginal[d].sd, 0.9 * one.marginal[d].sd) << d;
  }
}

// A live process warms up on packs of its own.
TEST(StateFilter, ResetEqualsAFreshEstimator) {
  const auto plant = test::Program(Oscillator());
  test::Rig fresh(DescribedSettings(plant)), used(DescribedSettings(plant));
  const auto pack = [&](std::int64_t seq, double phase) {
    return DescribedPack(
        *plant, seq,
        [&](double t) {
          return PlantSample{{Drive(t)}, std::sin(5.0 * t + phase)};
        },
        50, kDt);
  };
  for (std::int64_t seq = 1; seq <= 3; ++seq) (void)used.Step(pack(seq, 1.0));
  used.estimator.Reset();
  for (std::int64_t seq = 1; seq <= 3; ++seq)
    test::ExpectSameBits(fresh.Step(pack(seq, 0.0)), used.Step(pack(seq, 0.0)));
}

struct Begun {
  int packs;
  double speed;
};

class Intervals : public testing::TestWithParam<Begun> {};

TEST_P(Intervals, HoldTheTruthAsOftenAsTheySay) {
  const auto [packs, speed] = GetParam();
  double square = 0.0;
  int out = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const ModeEstimate mode = PosteriorAfter({packs, 50, speed, seed});
    for (std::size_t d = 0; d < kParameters; ++d) {
      square += Distance(mode, d) * Distance(mode, d);
      out += std::fabs(Distance(mode, d)) > 1.96 ? 1 : 0;
      EXPECT_LT(mode.marginal[d].sd, (packs > 5 ? 0.01 : 0.5) * Reference().theta[d]) << d;
    }
  }
  // Of 18, correlated within a run.
  EXPECT_LT(square, 40.0);
  EXPECT_LE(out, 4);
}

INSTANTIATE_TEST_SUITE_P(StateFilter, Intervals,
                         testing::Values(Begun{2, 0.0}, Begun{10, 0.0}, Begun{2, 0.7}, Begun{10, 0.7}),
                         [](const auto& info) { return "n" + std::to_string(info.index); });

}  // namespace
}  // namespace armcmc::state_filter_test
