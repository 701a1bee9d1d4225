#include "armcmc/interleaved_estimator.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdint>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "armcmc/last_pack.hpp"
#include "armcmc/snapshot.hpp"
#include "core/estimator_rig.hpp"
#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"
#include "support/alloc_counter.hpp"

namespace armcmc::interleaved_estimator_test {
namespace {

using test::Rig;

constexpr int kSamples = 100;
constexpr int kOverlap = 4;
constexpr int kStride = kSamples / kOverlap;

/// An interleaved estimator with one slot, run stage after stage.
class Interleaved {
 public:
  explicit Interleaved(const EstimatorSettings& settings)
      : estimator(settings), result_(estimator.MakeResult()), estimate_(std::make_unique<Estimate>()) {}

  const Estimate& Step(const DataPack& pack) {
    status = estimator.Adjust(pack, 0, {}, result_.get());
    estimator.Execute(*result_, estimate_.get());
    return *estimate_;
  }

  InterleavedEstimator estimator;
  Status status = Status::kOk;

 private:
  std::unique_ptr<AdjustResult> result_;
  std::unique_ptr<Estimate> estimate_;
};

/// The measurements of one run, and the packs that a plant cuts from them: pack k holds the samples (k-1) S .. (k-1) S
/// + N - 1.
struct Series {
  std::vector<test::PlantSample> samples;
  DataPack blank;

  [[nodiscard]] DataPack Pack(std::int64_t seq) const {
    DataPack pack = blank;
    pack.seq = seq;
    const std::size_t first = static_cast<std::size_t>(seq - 1) * kStride;
    for (std::size_t n = 0; n < kSamples; ++n) {
      pack.u[n] = samples.at(first + n).u;
      pack.y[n] = samples.at(first + n).y;
    }
    pack.t_last_s = static_cast<double>(first + kSamples - 1) * pack.dt;
    return pack;
  }
  [[nodiscard]] std::int64_t num_packs() const {
    return (static_cast<std::int64_t>(samples.size()) - kSamples) / kStride + 1;
  }
};

Series MakeSeries(const PlantProgram& plant, int packs, const std::function<test::PlantSample(double t)>& sample_at) {
  Series series;
  series.blank = test::DescribedPack(plant, 1, sample_at, kSamples);
  for (int n = 0; n < kSamples + (packs - 1) * kStride; ++n) series.samples.push_back(sample_at(1e-3 * n));
  return series;
}

EstimatorSettings Overlapping(EstimatorSettings settings) {
  settings.overlap = kOverlap;
  return settings;
}

Series AxisSeries(const PlantProgram& plant, int packs) {
  test::GaussianNoise noise(1.0);
  return MakeSeries(plant, packs, [&noise](double t) {
    test::PlantSample s;
    s.u[0] = 0.1 * std::sin(7.0 * t) + 0.05 * std::sin(31.0 * t);
    s.u[1] = 0.7 * std::cos(7.0 * t) + 1.55 * std::cos(31.0 * t);
    s.y = 95.0 * s.u[1] + 210.0 * s.u[0] - 3.0 + noise();
    return s;
  });
}

/// The contact of the paper, through its surface and back.
Series ContactSeries(int packs) {
  test::Normal normal(5);
  const test::ContactTruth truth;
  Series series;
  series.blank = test::BlankPack(HuntCrossley::kInfo.plant, 1);
  for (int n = 0; n < kSamples + (packs - 1) * kStride; ++n) {
    const test::Place at = test::Contact::At(1e-3 * n);
    series.samples.push_back({{at.x, at.v}, truth.Force(at.x, at.v) + 0.1 * normal()});
  }
  return series;
}

/// Mean and standard deviation of the axis' parameters from the samples [first, end) and the prior.
struct Batch {
  Eigen::Vector3d mean, sd;
};
Batch LeastSquares(const Series& series, std::size_t first, std::size_t end, const EstimatorSettings& settings) {
  Eigen::Matrix3d precision = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t d = 0; d < 3; ++d) {
    const auto i = static_cast<Eigen::Index>(d);
    precision(i, i) = std::pow(settings.parameters[d].sd, -2.0);
    right[i] = precision(i, i) * settings.parameters[d].mean;
  }
  for (std::size_t n = first; n < end; ++n) {
    const test::PlantSample& s = series.samples[n];
    const Eigen::Vector3d row(s.u[1], s.u[0], 1.0);
    precision += row * row.transpose();
    right += row * s.y;
  }
  const Eigen::Matrix3d covariance = precision.inverse();
  return {covariance * right, covariance.diagonal().cwiseSqrt()};
}

/// How far the posterior of the axis after a pack is from least squares: of the mean in standard deviations, and the
/// ratio of the standard deviations.
struct Distance {
  double mean = 0.0, sd_ratio = 1.0;
};
Distance FromLeastSquares(const Estimate& estimate, const Batch& batch, int d) {
  const MarginalSummary& m = estimate.modes[0].marginal[static_cast<std::size_t>(d)];
  return {std::fabs(m.ar_ap - batch.mean[d]) / batch.sd[d], m.sd / batch.sd[d]};
}

EstimatorSettings AxisSettings(const std::shared_ptr<const PlantProgram>& plant) {
  EstimatorSettings settings = DescribedSettings(plant);
  settings.forgetting.drift_share = 0.0;  // least squares does not expect any
  return settings;
}

TEST(InterleavedEstimator, CountsEverySampleOnce) {
  const auto plant = test::Program(test::DescribedAxis());
  const EstimatorSettings settings = Overlapping(AxisSettings(plant));
  const Series series = AxisSeries(*plant, 24);
  Interleaved interleaved(settings);
  for (std::int64_t seq = 1; seq <= series.num_packs(); ++seq) {
    const Estimate& e = interleaved.Step(series.Pack(seq));
    ASSERT_EQ(interleaved.status, Status::kOk);
    // The recursion's first pack is one of the first four.
    const std::size_t first = static_cast<std::size_t>((seq - 1) % kOverlap) * kStride;
    const std::size_t end = static_cast<std::size_t>(seq - 1) * kStride + kSamples;
    const Batch batch = LeastSquares(series, first, end, settings);
    for (int d = 0; d < 3; ++d) {
      const Distance distance = FromLeastSquares(e, batch, d);
      EXPECT_LT(distance.mean, 0.1) << "pack " << seq << ", parameter " << d;
      EXPECT_NEAR(distance.sd_ratio, 1.0, 0.05) << "pack " << seq << ", parameter " << d;
    }
  }
}

TEST(InterleavedEstimator, OneRecursionForAllPacksWouldCountSamplesAgain) {
  const auto plant = test::Program(test::DescribedAxis());
  const EstimatorSettings settings = AxisSettings(plant);
  const Series series = AxisSeries(*plant, 24);
  Rig rig(settings);
  for (std::int64_t seq = 1; seq <= series.num_packs(); ++seq) rig.Step(series.Pack(seq));
  const Batch batch = LeastSquares(series, 0, series.samples.size(), settings);
  for (int d = 0; d < 3; ++d) {
    const double ratio = FromLeastSquares(rig.estimate(), batch, d).sd_ratio;
    EXPECT_GT(ratio, 0.8 / std::sqrt(kOverlap));
    EXPECT_LT(ratio, 1.3 / std::sqrt(kOverlap));
  }
}

TEST(InterleavedEstimator, WithoutOverlapIsOneEstimatorToTheBit) {
  Interleaved interleaved(BuiltinSettings("hunt_crossley"));
  Rig plain(BuiltinSettings("hunt_crossley"));
  EXPECT_EQ(interleaved.estimator.overlap(), 1);
  for (std::int64_t seq = 36; seq <= 66; ++seq) {
    plain.Step(test::Contact{}.Pack(seq));
    test::ExpectSameBits(interleaved.Step(test::Contact{}.Pack(seq)), plain.estimate());
    EXPECT_EQ(interleaved.status, plain.status);
  }
}

/// Each recursion against an estimator that gets its packs alone, so that what recursions share carries nothing over.
void ExpectRecursionsOfTheirOwn(const EstimatorSettings& settings, const Series& series) {
  Interleaved interleaved(settings);
  std::vector<std::unique_ptr<Rig>> alone;
  alone.reserve(kOverlap);
  for (int j = 0; j < kOverlap; ++j) alone.push_back(std::make_unique<Rig>(settings));
  for (std::int64_t seq = 1; seq <= series.num_packs(); ++seq) {
    Rig& own = *alone[static_cast<std::size_t>(seq % kOverlap)];
    own.Step(series.Pack(seq));
    test::ExpectSameBits(interleaved.Step(series.Pack(seq)), own.estimate());
  }
}

TEST(InterleavedEstimator, ARecursionOfAContactIsAnEstimatorOfItsOwnPacks) {
  ExpectRecursionsOfTheirOwn(Overlapping(BuiltinSettings("hunt_crossley")), ContactSeries(60));
}

TEST(InterleavedEstimator, ARecursionOfAPlantWithStatesGoesOnFromItsOwnPackBefore) {
  const auto plant = test::Program(test::LeakyVessel());
  test::GaussianNoise noise(0.01);
  double level = 0.0;
  const Series series = MakeSeries(*plant, 24, [&](double t) {
    test::PlantSample s;
    s.u[0] = std::sin(9.0 * t) > 0.0 ? 1.0 : 0.2;
    s.y = level + noise();
    level += 1e-3 * (1.5 * s.u[0] - 2.0 * level);
    return s;
  });
  ExpectRecursionsOfTheirOwn(Overlapping(DescribedSettings(plant)), series);
  // Who takes every pack for a new start sees less.
  Rig goes_on(Overlapping(DescribedSettings(plant))), starts_anew(DescribedSettings(plant));
  for (std::int64_t seq = 4; seq <= series.num_packs(); seq += kOverlap) {
    goes_on.Step(series.Pack(seq));
    starts_anew.Step(series.Pack(seq));
    const double sd = goes_on.estimate().modes[0].marginal[0].sd, anew = starts_anew.estimate().modes[0].marginal[0].sd;
    if (seq == 4) {
      EXPECT_EQ(sd, anew);
    } else {
      EXPECT_LT(sd, anew) << seq;
    }
  }
}

/// What a plant remembers from pack to pack holds for the packs of a recursion: whoever takes each for a new start
/// computes something else from the same packs and the same random numbers.
void ExpectMemory(const EstimatorSettings& settings, const std::function<DataPack(std::int64_t k)>& pack_at,
                  const std::string& what) {
  Rig goes_on(Overlapping(settings)), starts_anew(settings);
  bool differs = false;
  for (std::int64_t k = 1; k <= 6; ++k) {
    DataPack pack = pack_at(k);
    pack.seq = kOverlap * k;
    const Estimate &a = goes_on.Step(pack), &b = starts_anew.Step(pack);
    ASSERT_TRUE(goes_on.status == Status::kOk || goes_on.status == Status::kHeld) << what << ", pack " << k;
    differs = differs || !test::SameBits(a.modes[0].marginal[0].sd, b.modes[0].marginal[0].sd) ||
              !test::SameBits(a.y_shown_free_run[0], b.y_shown_free_run[0]);
    if (k == 1) {
      ASSERT_FALSE(differs) << what;
    }
  }
  EXPECT_TRUE(differs) << what;
}

TEST(InterleavedEstimator, PlantsRememberFromPackToPackOfARecursion) {
  const auto actuator = [](std::int64_t k) { return test::Actuator{}.Pack(k, 50); };
  ExpectMemory(test::ActuatorSettings(), actuator, "bending");
  EstimatorSettings lagging = test::ActuatorSettings();
  lagging.effects[0] = MakeEffect(SoftActuator::kInfo, "valve_lag");
  lagging.num_effects = 1;
  lagging.noise[0].std = lagging.noise[1].std = 1e4;  // of the pressure rate
  ExpectMemory(lagging, actuator, "valve lag");
  EstimatorSettings contact = BuiltinSettings("hunt_crossley");
  contact.effects[0] = MakeEffect(HuntCrossley::kInfo, "sensor_lag");
  contact.num_effects = 1;
  ExpectMemory(
      contact, [](std::int64_t k) { return test::Contact{}.Pack(k + 8); }, "sensor lag");
  PlantDescription description = test::DescribedAxis();
  description.law = "M*lowpass(a, 0.05) + Fv*v + off";
  const auto plant = test::Program(description);
  const Series series = AxisSeries(*plant, 24);
  ExpectMemory(
      DescribedSettings(plant), [&series](std::int64_t k) { return series.Pack(kOverlap * (k - 1) + 1); }, "lowpass");
}

TEST(InterleavedEstimator, ShowsTheGapWatchOfTheFirstRecursionWithEveryPack) {
  const EstimatorSettings settings = Overlapping(BuiltinSettings("hunt_crossley"));
  const Series series = ContactSeries(1000);
  Interleaved interleaved(settings);
  Rig alone(settings);
  int blocks = 0;
  for (std::int64_t seq = 1; seq <= series.num_packs(); ++seq) {
    if (seq % kOverlap == 0) alone.Step(series.Pack(seq));
    const GapState& gap = interleaved.Step(series.Pack(seq)).gap;
    const GapState& expected = alone.estimator.gap();
    EXPECT_TRUE(gap.watched) << seq;
    EXPECT_EQ(gap.num_blocks, expected.num_blocks) << seq;
    EXPECT_EQ(gap.log_evidence, expected.log_evidence) << seq;
    blocks = static_cast<int>(gap.num_blocks);
  }
  EXPECT_GE(blocks, 1);
}

TEST(InterleavedEstimator, MakesUpForWhatWasNotRemembered) {
  const EstimatorSettings settings = Overlapping(BuiltinSettings("hunt_crossley"));
  const Series series = ContactSeries(12);
  Interleaved in_turn(settings);
  InterleavedEstimator lagging(settings);
  const auto estimate = std::make_unique<Estimate>();
  const auto result = lagging.MakeResult();
  for (std::int64_t seq = 1; seq <= series.num_packs(); ++seq) {
    (void)lagging.Draw(series.Pack(seq), 0, {}, result.get());
    lagging.Execute(*result, estimate.get());
    test::ExpectSameBits(in_turn.Step(series.Pack(seq)), *estimate);
  }
}

TEST(InterleavedEstimator, ForgetsAllRecursions) {
  const EstimatorSettings settings = Overlapping(BuiltinSettings("hunt_crossley"));
  const Series series = ContactSeries(12);
  Interleaved used(settings), fresh(settings);
  for (std::int64_t seq = 1; seq <= 8; ++seq) used.Step(series.Pack(seq));
  used.estimator.Reset();
  for (std::int64_t seq = 1; seq <= 8; ++seq)
    test::ExpectSameBits(used.Step(series.Pack(seq)), fresh.Step(series.Pack(seq)));
}

TEST(InterleavedEstimator, GoesOnFromTheSnapshotsOfItsRecursionsToTheBit) {
  // Saved in the middle of a turn, in contact and in free motion.
  const EstimatorSettings settings = Overlapping(BuiltinSettings("hunt_crossley"));
  const Series series = ContactSeries(60);
  for (const std::int64_t saved : {std::int64_t{6}, std::int64_t{39}}) {
    Interleaved first(settings), second(settings);
    for (std::int64_t seq = 1; seq <= saved; ++seq) first.Step(series.Pack(seq));
    for (int j = 0; j < kOverlap; ++j) {
      std::vector<std::byte> adjusted(Estimator::kSnapshotBytes), executed(Estimator::kSnapshotBytes);
      Estimator& from = first.estimator.recursion(j);
      adjusted.resize(from.SaveAdjusted(adjusted));
      executed.resize(from.SaveExecuted(executed));
      ASSERT_TRUE(second.estimator.recursion(j).Restore(adjusted, executed)) << j;
    }
    for (std::int64_t seq = saved + 1; seq <= series.num_packs(); ++seq)
      test::ExpectSameBits(first.Step(series.Pack(seq)), second.Step(series.Pack(seq)));
  }
}

TEST(InterleavedEstimator, RefusesPacksThatTheOverlapDoesNotDivide) {
  Interleaved interleaved(Overlapping(BuiltinSettings("hunt_crossley")));
  DataPack pack = ContactSeries(1).Pack(1);
  for (const int samples : {98, 99, 97, 3}) {
    pack.num_samples = samples;
    interleaved.Step(pack);
    EXPECT_EQ(interleaved.status, Status::kBadPack) << samples;
  }
  pack.num_samples = 96;
  interleaved.Step(pack);
  EXPECT_EQ(interleaved.status, Status::kOk);
  // The last number has no successor: with signed overflow checked its step fails if that is computed.
  for (const std::int64_t seq : {std::int64_t{0}, std::int64_t{-5}, std::numeric_limits<std::int64_t>::max()}) {
    pack.seq = seq;
    interleaved.Step(pack);
    EXPECT_EQ(interleaved.status, seq > 0 ? Status::kOk : Status::kBadPack) << seq;
  }
}

TEST(InterleavedEstimator, StepsDoNotTouchTheHeap) {
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  const Series series = ContactSeries(16);
  Interleaved interleaved(Overlapping(BuiltinSettings("hunt_crossley")));
  std::vector<DataPack> packs;
  for (std::int64_t seq = 1; seq <= series.num_packs(); ++seq) packs.push_back(series.Pack(seq));
  const test::AllocCounter guard;
  for (const DataPack& pack : packs) interleaved.Step(pack);
  interleaved.estimator.Reset();
  EXPECT_EQ(guard.count() + guard.frees(), 0);
}

TEST(Overlap, IsInRange) {
  for (const int overlap : {0, -1, kMaxPackSamples + 1}) {
    EstimatorSettings settings = BuiltinSettings("hunt_crossley");
    settings.overlap = overlap;
    EXPECT_THROW(settings.Validate(), std::invalid_argument) << overlap;
    EXPECT_THROW(InterleavedEstimator{settings}, std::invalid_argument) << overlap;
  }
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.overlap = kMaxPackSamples;
  EXPECT_NO_THROW(settings.Validate());
}

TEST(Overlap, IsPartOfWhatGivesASnapshotItsMeaning) {
  const EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  EXPECT_NE(SnapshotIdentity(settings), SnapshotIdentity(Overlapping(settings)));
}

TEST(Overlap, APackGoesOnFromTheOneThatItsSamplesFollow) {
  DataPack pack;
  pack.seq = 7;
  pack.run_id = 2;
  pack.dt = 1e-3;
  const LastPack last = LastPack::Of(pack);
  for (const int step : {1, 4}) {
    pack.seq_step = step;
    for (std::int64_t seq = 6; seq <= 12; ++seq) {
      pack.seq = seq;
      EXPECT_EQ(last.ContinuesWith(pack), seq == 7 + step) << step << ' ' << seq;
    }
  }
}

}  // namespace
}  // namespace armcmc::interleaved_estimator_test
