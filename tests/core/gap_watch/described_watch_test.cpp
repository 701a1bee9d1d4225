#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "armcmc/gap_watch/gap_watch.hpp"
#include "armcmc/models/registry.hpp"
#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"
#include "simd/kernels.hpp"
#include "support/alloc_counter.hpp"

namespace armcmc::described_watch_test {
namespace {

using Sample = test::PlantSample;

constexpr double kMinute = 60.0;

/// An axis that also measures where it is: q, v, a.
PlantDescription Axis() {
  PlantDescription plant = test::DescribedAxis();
  plant.signals.insert(plant.signals.begin(), {"q", "m", "position", ""});
  return plant;
}

/// Two sines that are no multiples of each other or of a pack.
Sample Moving(double t) {
  Sample s;
  s.u[0] = 0.3 * std::sin(2.3 * t) + 0.1 * std::sin(7.1 * t);
  s.u[1] = 0.69 * std::cos(2.3 * t) + 0.71 * std::cos(7.1 * t);
  s.u[2] = -1.587 * std::sin(2.3 * t) - 5.041 * std::sin(7.1 * t);
  return s;
}

double Law(const Sample& s) { return 95.0 * s.u[2] + 210.0 * s.u[1] - 3.0; }

/// The watch alone, told parameters that are a little wrong.
class Rig {
 public:
  explicit Rig(PlantDescription plant, const std::array<double, kMaxParams>& theta, double tolerance = 0.03)
      : program_(test::Program(std::move(plant))), settings_(DescribedSettings(program_)) {
    settings_.gap_watch.tolerance = tolerance;
    watch_ = std::make_unique<GapWatch>(settings_, FindModel(settings_.model), simd::Best(),
                                        settings_.gap_watch.false_alarm_rate);
    for (int m = 0; m < program_->info().num_modes; ++m) {
      told_.known[static_cast<std::size_t>(m)] = true;
      told_.theta[static_cast<std::size_t>(m)] = theta;
      told_.noise_std[static_cast<std::size_t>(m)] = settings_.noise[0].std;
    }
  }

  /// @return time of the alarm, s; 0: none.
  template <class SampleAt, class OnStep>
  double Run(double seconds, const SampleAt& sample_at, const OnStep& on_step) {
    for (std::int64_t seq = 1; 0.1 * static_cast<double>(seq) < seconds; ++seq) {
      watch_->Step(test::DescribedPack(*program_, seq, sample_at), told_, false);
      on_step(watch_->state());
    }
    return 0.1 * static_cast<double>(watch_->state().alarm_seq);
  }
  template <class SampleAt>
  double Run(double seconds, const SampleAt& sample_at) {
    return Run(seconds, sample_at, [](const GapState&) {});
  }

  [[nodiscard]] const GapWatch& watch() const { return *watch_; }
  [[nodiscard]] GapWatch& watch() { return *watch_; }
  [[nodiscard]] const PlantProgram& program() const { return *program_; }
  GapReference& told() { return told_; }

 private:
  std::shared_ptr<const PlantProgram> program_;
  EstimatorSettings settings_;
  std::unique_ptr<GapWatch> watch_;
  GapReference told_;
};

constexpr std::array<double, kMaxParams> kNearTruth{95.5, 209.0, -2.8};

std::vector<std::string> Names(const GapWatch& watch) {
  std::vector<std::string> names;
  for (int check = 0; !watch.CheckName(check).empty(); ++check) names.emplace_back(watch.CheckName(check));
  return names;
}

TEST(DescribedWatch, HasChecksForWhatItsSignalsAre) {
  const Rig axis(Axis(), kNearTruth);
  const std::vector<std::string> expected{"everywhere",
                                          "output_rate",
                                          "high_output",
                                          "direction_of_v",
                                          "v",
                                          "slow_v",
                                          "reversal_of_v",
                                          "high_q",
                                          "low_q",
                                          "square_of_q",
                                          "high_a",
                                          "square_of_a",
                                          "a",
                                          "repeats_after_a_pack",
                                          "repeats_after_two_packs",
                                          "slow_wander",
                                          "wander_after_two_packs"};
  EXPECT_EQ(Names(axis.watch()), expected);
}

TEST(DescribedWatch, NoCheckDependsOnWhatIsExplained) {
  PlantDescription vessel = test::DescribedVessel();
  vessel.predicts.clear();
  vessel.states.clear();
  vessel.output = "y";
  const Rig rig(vessel, {2.0});
  EXPECT_TRUE(rig.watch().enabled());
  const std::vector<std::string> expected{"everywhere",
                                          "output_rate",
                                          "high_output",
                                          "in_drain",
                                          "high_u",
                                          "square_of_u",
                                          "u",
                                          "repeats_after_a_pack",
                                          "repeats_after_two_packs",
                                          "slow_wander",
                                          "wander_after_two_packs"};
  EXPECT_EQ(Names(rig.watch()), expected);
}

TEST(DescribedWatch, IsSilentWhenNothingIsMissing) {
  // The rate allows 0.01 an hour, so one alarm in 20 minutes is a fault.
  for (const unsigned seed : {1U, 2U}) {
    for (const bool heavy_tails : {false, true}) {
      Rig rig(Axis(), kNearTruth);
      std::mt19937_64 random(seed);
      std::normal_distribution<double> normal;
      std::student_t_distribution<double> student(4.0);
      const auto sample = [&](double t) {
        Sample s = Moving(t);
        s.y = Law(s) + (heavy_tails ? student(random) / std::sqrt(2.0) : normal(random));
        return s;
      };
      EXPECT_EQ(rig.Run(5.0 * kMinute, sample), 0.0) << seed << ": " << rig.watch().state().where.view();
      EXPECT_GE(rig.watch().state().num_blocks, 23);
    }
  }
}

TEST(DescribedWatch, BetsDoNotPayWhenNothingIsMissing) {
  std::array<double, kMaxGapChecks> sum{};
  int blocks = 0;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int run = 0; run < 12; ++run) {
    Rig rig(Axis(), kNearTruth, 0.0);
    std::int64_t seen = 0;
    const auto sample = [&](double t) {
      Sample s = Moving(t + 0.37 * run);
      s.y = Law(s) + normal(random);
      return s;
    };
    rig.Run(2.0 * kMinute, sample, [&](const GapState& state) {
      if (state.num_blocks == seen) return;
      seen = state.num_blocks;
      ++blocks;
      for (std::size_t c = 0; c < kMaxGapChecks; ++c)
        for (const double sign : {1.0, -1.0})
          sum[c] += 0.5 * std::exp(sign * rig.watch().scores()[c].z - rig.watch().scores()[c].margin - 0.5);
    });
  }
  ASSERT_GE(blocks, 100);
  for (std::size_t c = 0; c < kMaxGapChecks; ++c) EXPECT_LT(sum[c] / blocks, 1.0 + 4.0 / std::sqrt(blocks)) << c;
}

TEST(DescribedWatch, TakesADriftForWhatItIs) {
  Rig rig(Axis(), kNearTruth);
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  const auto drifting = [&](double t) {
    Sample s = Moving(t);
    s.y = Law(s) + 0.3 * t * s.u[1] + normal(random);
    return s;
  };
  EXPECT_EQ(rig.Run(kMinute, drifting), 0.0) << rig.watch().state().where.view();
}

struct Missing {
  const char* name;
  double (*force)(const Sample&);
  const char* where;  ///< Seen there; empty: that is left open.
};

TEST(DescribedWatch, FindsWhatIsMissing) {
  // Each about half the noise in size.
  const std::vector<Missing> all = {
      {"Coulomb friction", [](const Sample& s) { return s.u[1] > 0.0 ? 0.6 : -0.6; }, "direction_of_v"},
      {"drag", [](const Sample& s) { return 0.7 * s.u[1] * std::fabs(s.u[1]); }, ""},
      {"a spring", [](const Sample& s) { return 2.5 * s.u[0]; }, ""},
      {"a stop at one end", [](const Sample& s) { return s.u[0] > 0.2 ? 20.0 * (s.u[0] - 0.2) : 0.0; }, ""},
  };
  for (const Missing& missing : all) {
    Rig rig(Axis(), kNearTruth);
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    const auto sample = [&](double t) {
      Sample s = Moving(t);
      s.y = Law(s) + missing.force(s) + normal(random);
      return s;
    };
    EXPECT_GT(rig.Run(kMinute, sample), 0.0) << missing.name;
    EXPECT_GT(rig.watch().state().share, 0.0) << missing.name;
    if (*missing.where != '\0') {
      EXPECT_EQ(rig.watch().state().where.view(), missing.where) << missing.name;
    }
  }
}

/// In contact about half of the time.
Sample Tapping(double t) {
  Sample s;
  s.u[0] = 0.6 * std::sin(2.3 * t) + 0.1 * std::sin(7.1 * t);
  s.u[1] = 1.38 * std::cos(2.3 * t) + 0.71 * std::cos(7.1 * t);
  return s;
}

TEST(DescribedWatch, JudgesAPassiveModeThatSaysWhatIsMeasuredInIt) {
  // A bias that contact hides: the sensor's zero is off in the air alone.
  for (const bool says : {true, false}) {
    PlantDescription contact = test::DescribedContact();
    if (says) contact.modes[1].law = "0";
    Rig rig(contact, {4.0, 2.3, 1.7});
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    const auto sample = [&](double t) {
      Sample s = Tapping(t);
      const bool touches = s.u[0] >= 0.0;
      s.y = (touches ? std::pow(s.u[0], 1.7) * (4.0 + 2.3 * s.u[1]) : 0.07) + 0.1 * normal(random);
      return s;
    };
    EXPECT_EQ(rig.Run(kMinute, sample) > 0.0, says) << rig.watch().state().where.view();
  }
}

TEST(DescribedWatch, LeavesAPassiveModeAloneThatSaysNothing) {
  // Near the surface the force is 0; what it is far from it, the file leaves open.
  PlantDescription contact = test::DescribedContact();
  contact.modes = {contact.modes[0], {"near", "x > -0.3", "0", "", true}, {"far", "", "", "", true}};
  for (const bool far : {true, false}) {
    Rig rig(contact, {4.0, 2.3, 1.7});
    std::mt19937_64 random(8);
    std::normal_distribution<double> normal;
    const auto sample = [&](double t) {
      Sample s = Tapping(t);
      const bool biased = s.u[0] < 0.0 && (s.u[0] <= -0.3) == far;
      s.y = (s.u[0] >= 0.0 ? std::pow(s.u[0], 1.7) * (4.0 + 2.3 * s.u[1]) : 0.0) + (biased ? 0.1 : 0.0) +
            0.1 * normal(random);
      return s;
    };
    EXPECT_EQ(rig.Run(kMinute, sample) > 0.0, !far) << rig.watch().state().where.view();
  }
}

TEST(DescribedWatch, AllocatesNothing) {
  Rig rig(Axis(), kNearTruth);
  std::vector<DataPack> packs;
  packs.reserve(300);
  for (std::int64_t seq = 1; seq <= 300; ++seq)
    packs.push_back(test::DescribedPack(rig.program(), seq, [](double t) {
      Sample s = Moving(t);
      s.y = Law(s);
      return s;
    }));
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  const auto watch = [&] {
    for (const DataPack& pack : packs) rig.watch().Step(pack, rig.told(), false);
  };
  EXPECT_EQ(test::AllocationsOf(watch), 0);
  EXPECT_GE(rig.watch().state().num_blocks, 1);
}

}  // namespace
}  // namespace armcmc::described_watch_test
