// The watch over plants whose law needs states.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "armcmc/gap_watch/gap_starts.hpp"
#include "armcmc/gap_watch/gap_watch.hpp"
#include "armcmc/models/registry.hpp"
#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"
#include "simd/kernels.hpp"
#include "support/alloc_counter.hpp"

namespace armcmc::state_watch_test {
namespace {

constexpr double kDt = 0.01;   // s
constexpr double kStd = 0.01;  // rad
constexpr int kPackSamples = 100;
constexpr int kJoined = 2;  // packs in one stretch of a block
constexpr int kBlock = kJoined * kGapBlockPacks;
/// Until a block is judged: it is recorded, then analysed beside the next one.
constexpr int PacksFor(int blocks) { return (blocks + 1) * kBlock; }

PlantDescription Pendulum() {
  PlantDescription plant;
  plant.name = "swing";
  plant.output = "y";
  plant.law = "angle";
  plant.signals = {{"u", "1/s^2", "drive", ""}, {"y", "1", "position", ""}};
  plant.parameters = {{"w2", "1/s^2", "normal", 30.0, 30.0, 0.0, 1000.0},
                      {"d", "1/s", "normal", 0.5, 1.0, 0.0, 50.0},
                      {"b", "1", "normal", 1.0, 4.0, -100.0, 100.0}};
  plant.states = {{"angle", "1", "position", "speed", "y", ""},
                  {"speed", "1/s", "velocity", "b*u - d*speed - w2*sin(angle)", "0", ""}};
  plant.noise.std = kStd;
  return plant;
}

/// What the plant file does not know.
struct Truth {
  /// Added to the angular acceleration.
  std::function<double(double t, double angle, double speed)> force;
  double kick = 0.0;  ///< Of the speed between one stretch and the next, rad/s rms.
  bool heavy_tails = false;
  double drift = 0.0, step = 0.0;  ///< Of w2: 1/s^3, and 1/s^2 in the middle of block 1.
};

double Input(double t) { return 4.0 * std::sin(3.1 * t) + 3.0 * std::sin(5.3 * t + 1.0) + 2.0 * std::sin(7.7 * t); }

/// Integrated here, four steps a sample.
class Swing {
 public:
  Swing(Truth truth, unsigned seed) : truth_(std::move(truth)), random_(seed) {}

  void Fill(DataPack* pack) {
    for (int n = 0; n < pack->num_samples; ++n, ++sample_) {
      const double t = kDt * static_cast<double>(sample_);
      const auto in = static_cast<std::size_t>(n);
      pack->u[in][0] = Input(t);
      const double noise = truth_.heavy_tails ? student_(random_) / std::sqrt(2.0) : normal_(random_);
      pack->y[in] = x_[0] + kStd * noise;
      pack->t_last_s = t;
      Advance(t);
      if ((sample_ + 1) % (kJoined * kPackSamples) == 0) x_[1] += truth_.kick * normal_(random_);
    }
  }

 private:
  using State = std::array<double, 2>;
  [[nodiscard]] State Rate(double t, double u, const State& x) const {
    const double w2 = 31.0 + truth_.drift * t + (t > kDt * kPackSamples * 1.5 * kBlock ? truth_.step : 0.0);
    const double more = truth_.force ? truth_.force(t, x[0], x[1]) : 0.0;
    return {x[1], 1.05 * u - 0.6 * x[1] - w2 * std::sin(x[0]) + more};
  }
  void Advance(double t) {
    constexpr int kSteps = 4;
    const double h = kDt / kSteps, from = Input(t), to = Input(t + kDt);
    for (int i = 0; i < kSteps; ++i) {
      const auto at = [&](double part) { return from + (to - from) * (i + part) / kSteps; };
      const auto moved = [&](const State& k, double by) { return State{x_[0] + by * k[0], x_[1] + by * k[1]}; };
      const double now = t + i * h;
      const State k1 = Rate(now, at(0.0), x_), k2 = Rate(now + h / 2, at(0.5), moved(k1, h / 2));
      const State k3 = Rate(now + h / 2, at(0.5), moved(k2, h / 2)), k4 = Rate(now + h, at(1.0), moved(k3, h));
      for (std::size_t s = 0; s < 2; ++s) x_[s] += h / 6.0 * (k1[s] + 2.0 * k2[s] + 2.0 * k3[s] + k4[s]);
    }
  }

  Truth truth_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::student_t_distribution<double> student_{4.0};
  State x_{};
  std::int64_t sample_ = 0;
};

/// The watch alone, told parameters that are a little wrong.
class Rig {
 public:
  explicit Rig(PlantDescription plant = Pendulum(), double tolerance = 0.03,
               const std::array<double, kMaxParams>& theta = {30.8, 0.61, 1.04})
      : program_(test::Program(std::move(plant))), settings_(DescribedSettings(program_)) {
    settings_.gap_watch.tolerance = tolerance;
    watch_ = std::make_unique<GapWatch>(settings_, FindModel(settings_.model), simd::Best(),
                                        settings_.gap_watch.false_alarm_rate);
    told_.known[0] = true;
    told_.theta[0] = theta;
    told_.noise_std[0] = settings_.noise[0].std;
    pack_.run_id = 1;
    pack_.plant = PlantNumber::kDescribed;
    pack_.fingerprint = program_->plant().fingerprint();
    pack_.dt = kDt;
    pack_.num_inputs = program_->info().num_inputs;
    pack_.num_samples = kPackSamples;
  }

  template <class Source>
  const DataPack& Next(Source* source) {
    ++pack_.seq;
    source->Fill(&pack_);
    return pack_;
  }
  /// @return block after which the alarm rose; 0: none.
  std::int64_t Run(int blocks, Swing swing, std::int64_t changed = 0) {
    for (int i = 0; i < PacksFor(blocks) && !watch_->state().suspected; ++i) {
      const DataPack& pack = Next(&swing);
      watch_->Step(pack, told_, pack.seq == changed);
    }
    return watch_->state().suspected ? watch_->state().num_blocks : 0;
  }

  [[nodiscard]] GapWatch& watch() { return *watch_; }
  [[nodiscard]] const GapReference& told() const { return told_; }

 private:
  std::shared_ptr<const PlantProgram> program_;
  EstimatorSettings settings_;
  std::unique_ptr<GapWatch> watch_;
  GapReference told_;
  DataPack pack_{};
};

/// Some check of the last block had something to say.
bool Judged(const GapWatch& watch) {
  return std::any_of(watch.scores().begin(), watch.scores().end(), [](const CheckScore& s) { return s.z != 0.0; });
}

std::vector<std::string> Names(const GapWatch& watch) {
  std::vector<std::string> names;
  for (int check = 0; !watch.CheckName(check).empty(); ++check) names.emplace_back(watch.CheckName(check));
  return names;
}

TEST(GapDirections, AreProjectedOut) {
  GapDirections directions;
  directions.Clear(50);
  GapDirections::Samples one{}, line{}, both{}, values{};
  for (std::size_t n = 0; n < 50; ++n) {
    one[n] = 1e5;
    line[n] = static_cast<double>(n);
    both[n] = 3.0 - 2.0 * line[n];
    values[n] = std::sin(0.3 * line[n]);
  }
  const GapDirections::Samples before = values;
  directions.Remove(&values);
  EXPECT_EQ(values, before) << "none yet";
  directions.Add(one);
  directions.Add(line);
  EXPECT_EQ(directions.count(), 2);
  directions.Add(both);
  EXPECT_EQ(directions.count(), 2) << "it is what the others make";
  double mean = 0.0, slope = 0.0, squares = 0.0;
  directions.Remove(&values);
  for (std::size_t n = 0; n < 50; ++n) {
    mean += values[n];
    slope += values[n] * line[n];
    squares += before[n] * before[n] - values[n] * values[n];
  }
  EXPECT_NEAR(mean, 0.0, 1e-12);
  EXPECT_NEAR(slope, 0.0, 1e-10);
  EXPECT_NEAR(directions.SquaresAlong(before), squares, 1e-12);
  directions.Remove(&both);
  EXPECT_EQ(both, GapDirections::Samples{}) << "rounding error is not left over";
}

TEST(StateWatch, HasChecksForTermsOfTheRates) {
  Rig rig;
  ASSERT_TRUE(rig.watch().enabled());
  const std::vector<std::string> expected{"everywhere",
                                          "output_rate",
                                          "high_output",
                                          "square_of_angle",
                                          "cube_of_angle",
                                          "direction_of_speed",
                                          "drag_of_speed",
                                          "angle",
                                          "push_on_speed",
                                          "speed",
                                          "bent_u",
                                          "high_u",
                                          "square_of_u",
                                          "u",
                                          "repeats_after_a_pack",
                                          "repeats_after_two_packs",
                                          "slow_wander",
                                          "wander_after_two_packs"};
  EXPECT_EQ(Names(rig.watch()), expected);
}

TEST(StateWatch, IsSilentWhenNothingIsMissing) {
  for (const bool heavy_tails : {false, true}) {
    Rig rig;
    Truth truth;
    truth.heavy_tails = heavy_tails;
    EXPECT_EQ(rig.Run(3, Swing(truth, 1)), 0) << rig.watch().state().where.view();
    EXPECT_EQ(rig.watch().state().num_blocks, 3);
    EXPECT_TRUE(Judged(rig.watch()));
  }
}

TEST(StateWatch, WhereStatesStartIsNoGap) {
  Rig rig;
  Truth truth;
  truth.kick = 0.5;
  EXPECT_EQ(rig.Run(2, Swing(truth, 2)), 0) << rig.watch().state().where.view();
  EXPECT_TRUE(Judged(rig.watch()));
}

TEST(StateWatch, FindsWhatTheRatesLack) {
  // Which check speaks loudest is left open: a small force looks like several of them.
  const std::vector<std::pair<std::string, std::function<double(double, double, double)>>> missing{
      {"Coulomb friction", [](double, double, double speed) { return speed > 0.0 ? -0.4 : 0.4; }},
      {"drag", [](double, double, double speed) { return -0.1 * speed * std::fabs(speed); }},
      {"quadratic stiffness", [](double, double angle, double) { return 1.0 * angle * angle; }},
      {"a load", [](double, double, double) { return 0.3; }}};
  for (const auto& [name, force] : missing) {
    Rig rig;
    Truth truth;
    truth.force = force;
    EXPECT_GE(rig.Run(2, Swing(truth, 3)), 1) << name << ": log evidence " << rig.watch().state().log_evidence;
    EXPECT_GT(rig.watch().state().share, 0.0) << name;
  }
}

TEST(StateWatch, TakesADriftForWhatItIs) {
  Rig rig;
  Truth truth;
  truth.drift = 2e-3;
  EXPECT_EQ(rig.Run(2, Swing(truth, 4)), 0) << rig.watch().state().where.view();
  EXPECT_TRUE(Judged(rig.watch()));
}

TEST(StateWatch, TakesAStepForWhatItIsWhenTheEstimatorSawIt) {
  for (const bool seen : {true, false}) {
    Rig rig;
    Truth truth;
    truth.step = 1.5;
    const std::int64_t blocks = rig.Run(2, Swing(truth, 5), seen ? 1 + kBlock * 3 / 2 : 0);
    EXPECT_EQ(blocks > 0, !seen) << rig.watch().state().where.view();
  }
}

TEST(StateWatch, JudgesNoBlockWhoseFitHasNotConverged) {
  Rig rig(Pendulum(), 0.03, {200.0, 10.0, -20.0});
  EXPECT_EQ(rig.Run(1, Swing({}, 6)), 0) << rig.watch().state().where.view();
  EXPECT_EQ(rig.watch().state().num_blocks, 1);
  EXPECT_FALSE(Judged(rig.watch()));
}

/// A valve that follows its input late: the lag is a state that the language makes.
class Valve {
 public:
  explicit Valve(double bias) : bias_(bias) {}
  void Fill(DataPack* pack) {
    for (int n = 0; n < pack->num_samples; ++n, ++sample_) {
      const double t = kDt * static_cast<double>(sample_), u = Input(t);
      if (sample_ > 0) {
        // Exact for an input that is linear between samples.
        const double e = std::exp(-kDt / kLag), g = (1.0 - e) * kLag / kDt;
        lagged_ = u + e * (lagged_ - last_) - g * (u - last_);
      }
      last_ = u;
      const auto in = static_cast<std::size_t>(n);
      pack->u[in][0] = u;
      pack->y[in] = 2.0 * lagged_ + bias_ * lagged_ * std::fabs(lagged_) + 0.1 * normal_(random_);
      pack->t_last_s = t;
    }
  }

 private:
  static constexpr double kLag = 0.2;
  double bias_, lagged_ = Input(0.0), last_ = 0.0;
  std::int64_t sample_ = 0;
  std::mt19937_64 random_{7};
  std::normal_distribution<double> normal_;
};

TEST(StateWatch, WatchesAFunctionWithMemoryThatParametersChange) {
  PlantDescription plant;
  plant.name = "valve";
  plant.output = "y";
  plant.law = "g*lowpass(u, tau)";
  plant.signals = {{"u", "V", "drive", ""}, {"y", "V", "", ""}};
  plant.parameters = {{"g", "1", "normal", 1.0, 2.0, 0.0, 10.0}, {"tau", "s", "normal", 0.1, 0.2, 0.01, 2.0}};
  plant.noise.std = 0.1;
  for (const double bias : {0.0, 0.01}) {
    Rig rig(plant, 0.03, {2.02, 0.203});
    ASSERT_TRUE(rig.watch().enabled());
    Valve valve(bias);
    for (int i = 0; i < PacksFor(2); ++i) rig.watch().Step(rig.Next(&valve), rig.told(), false);
    EXPECT_EQ(rig.watch().state().suspected, bias > 0.0) << rig.watch().state().where.view();
    EXPECT_TRUE(Judged(rig.watch()));
  }
}

TEST(StateWatch, AllocatesNothing) {
  Rig rig;
  Swing swing({}, 8);
  std::vector<DataPack> packs;
  packs.reserve(PacksFor(1));
  for (int i = 0; i < PacksFor(1); ++i) packs.push_back(rig.Next(&swing));
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  const auto watch = [&] {
    for (const DataPack& pack : packs) rig.watch().Step(pack, rig.told(), false);
  };
  EXPECT_EQ(test::AllocationsOf(watch), 0);
  EXPECT_EQ(rig.watch().state().num_blocks, 1);
}

}  // namespace
}  // namespace armcmc::state_watch_test
