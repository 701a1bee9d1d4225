#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "armcmc/snapshot.hpp"
#include "core/estimator_rig.hpp"
#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::described_snapshot_test {
namespace {

using test::DescribedPack;
using test::PlantSample;
using test::Rig;

struct Saved {
  std::vector<std::byte> adjusted, executed;
};

Saved SaveOf(const Estimator& estimator) {
  Saved saved{std::vector<std::byte>(Estimator::kSnapshotBytes), std::vector<std::byte>(Estimator::kSnapshotBytes)};
  saved.adjusted.resize(estimator.SaveAdjusted(saved.adjusted));
  saved.executed.resize(estimator.SaveExecuted(saved.executed));
  EXPECT_FALSE(saved.adjusted.empty() || saved.executed.empty());
  return saved;
}

/// Nothing is known of what its state is after a lost pack but the output.
PlantDescription Vessel() {
  PlantDescription plant = test::LeakyVessel();
  plant.states[0].rate = "b*u - a*sqrt(max(level, 0))*sqrt(max(level, 0))";  // not linear to the eye
  plant.noise.estimate = true;
  return plant;
}

DataPack VesselPack(const PlantProgram& plant, std::int64_t seq) {
  return DescribedPack(
      plant, seq,
      [](double t) {
        return PlantSample{{1.0 + std::sin(9.0 * t)}, 1.5 + 0.3 * std::sin(9.0 * t - 1.3) + 0.01 * std::sin(977.0 * t)};
      },
      60, 0.01);
}

TEST(DescribedSnapshot, APlantWithStatesGoesOnToTheBitAsAfterALostPack) {
  const auto plant = test::Program(Vessel());
  const EstimatorSettings settings = DescribedSettings(plant);
  Rig whole(settings), resumed(settings);
  for (std::int64_t seq = 1; seq <= 5; ++seq) (void)whole.Step(VesselPack(*plant, seq));
  const Saved saved = SaveOf(whole.estimator);
  ASSERT_TRUE(resumed.estimator.Restore(saved.adjusted, saved.executed));
  for (std::int64_t seq = 7; seq <= 9; ++seq) {
    const DataPack pack = VesselPack(*plant, seq);
    test::ExpectSameBits(whole.Step(pack), resumed.Step(pack));
  }
}

/// As many modes and parameters as there may be.
PlantDescription Largest() {
  PlantDescription plant;
  plant.name = "largest";
  plant.output = "f";
  plant.signals = {{"m", "1", "", ""}, {"x", "1", "", ""}, {"v", "1", "", ""}, {"f", "N", "force", ""}};
  for (const char* name : {"a", "b", "c", "d", "e", "g", "h", "k"})
    plant.parameters.push_back(
        {.name = name, .unit = "N", .mean = 1.0, .sd = 1.0, .lower = -10.0, .upper = 10.0, .per_mode = true});
  for (int mode = 0; mode < kMaxModes; ++mode) {
    const std::string number = std::to_string(mode);
    plant.modes.push_back(
        {"mode_" + number, "m == " + number, "a + b*x + c*v + d*x*v + e*x^2 + g*v^2 + h*x^2*v + k*x*v^2", "", false});
  }
  plant.noise.std = 0.1;
  return plant;
}

TEST(DescribedSnapshot, TheLargestPlantFits) {
  const auto plant = test::Program(Largest());
  const EstimatorSettings settings = DescribedSettings(plant);
  Rig whole(settings), resumed(settings);
  test::GaussianNoise noise(0.1);
  const auto pack_of = [&](std::int64_t seq) {
    const auto mode = static_cast<double>(seq % kMaxModes);
    return DescribedPack(*plant, seq, [&](double t) {
      const double x = std::sin(71.0 * t), v = std::cos(103.0 * t);
      return PlantSample{{mode, x, v}, 1.0 + x + v + x * v + x * x + v * v + x * x * v + x * v * v + noise()};
    });
  };
  for (std::int64_t seq = 1; seq <= 5 * kMaxModes; ++seq) (void)whole.Step(pack_of(seq));
  for (std::size_t m = 0; m < kMaxModes; ++m) ASSERT_TRUE(whole.estimate().modes[m].known) << m;
  const Saved saved = SaveOf(whole.estimator);
  ASSERT_TRUE(resumed.estimator.Restore(saved.adjusted, saved.executed));
  const DataPack next = pack_of(5 * kMaxModes + 1);
  test::ExpectSameBits(whole.Step(next), resumed.Step(next));
}

TEST(DescribedSnapshot, OneWithoutWhatTheStatesNeedIsTakenToo) {
  const auto plant = test::Program(Vessel());
  EstimatorSettings settings = DescribedSettings(plant);
  settings.forgetting.drift_share = 0.0;
  Rig whole(settings), resumed(settings);
  for (std::int64_t seq = 1; seq <= 5; ++seq) (void)whole.Step(VesselPack(*plant, seq));
  Saved saved = SaveOf(whole.estimator);
  constexpr std::size_t kNoDrift = 1;  // byte
  saved.adjusted.resize(saved.adjusted.size() - kNoDrift - (2 * kMaxParams + 1) * sizeof(double));
  ASSERT_TRUE(resumed.estimator.Restore(saved.adjusted, saved.executed));
  (void)resumed.Step(VesselPack(*plant, 7));
  EXPECT_EQ(resumed.estimate().modes[0].decision, Decision::kReinforcement);
}

TEST(DescribedSnapshot, BelongsToThePlantFile) {
  const std::uint64_t same = SnapshotIdentity(DescribedSettings(test::Program(Vessel())));
  const auto identity_with = [](const std::function<void(PlantDescription*)>& change) {
    PlantDescription plant = Vessel();
    change(&plant);
    return SnapshotIdentity(DescribedSettings(test::Program(plant)));
  };
  EXPECT_EQ(identity_with([](auto*) {}), same);
  EXPECT_EQ(identity_with([](auto* p) { p->title = "Another title"; }), same);
  EXPECT_NE(identity_with([](auto* p) { p->law = "1.01*level"; }), same);
  EXPECT_NE(identity_with([](auto* p) { p->states[0].rate = "b*u - a*level"; }), same);
  EXPECT_NE(identity_with([](auto* p) { p->states[0].start = "0.9*y"; }), same);
  EXPECT_NE(identity_with([](auto* p) { p->states[0].substeps = 2; }), same);
  EXPECT_NE(identity_with([](auto* p) { std::swap(p->parameters[0], p->parameters[1]); }), same);
  EXPECT_NE(identity_with([](auto* p) { p->parameters[0].mean = 1.1; }), same);
  EXPECT_NE(identity_with([](auto* p) {
              p->signals[0].unit = "1";
              p->parameters[1].unit = "V/s";
            }),
            same);
  EXPECT_NE(identity_with([](auto* p) {
              p->law = "level + c";
              p->parameters.push_back({"c", "V", "normal", 0.0, 1.0});
            }),
            same);
}

TEST(DescribedSnapshot, ThatOfACompiledPlantIsWhatItWas) {
  // Of snapshots on users' disks: another number here is a snapshot that is refused there.
  EXPECT_EQ(SnapshotIdentity(BuiltinSettings("hunt_crossley")), 0xb430c28043720fc7ULL);
  EXPECT_EQ(SnapshotIdentity(BuiltinSettings("soft_actuator")), 0xdfa6bede8ee5a333ULL);
}

}  // namespace
}  // namespace armcmc::described_snapshot_test
