#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "armcmc/plant/start_fit.hpp"
#include "armcmc/plant/states.hpp"
#include "core/kernel_sets.hpp"
#include "core/plant/described_packs.hpp"
#include "core/plant/oscillator.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::states_test {
namespace {

using test::DescribedPack;
using test::PlantSample;

using test::Drive;
using test::kDt;
using test::Laid;
using test::Oscillator;
using test::Reference;

/// Its rates are not linear, and have three steps a sample.
PlantDescription Pendulum() {
  PlantDescription plant = Oscillator();
  plant.name = "pendulum";
  plant.signals = {{"u", "1", "drive", ""}, {"y", "1", "position", ""}};
  plant.parameters = {{"m", "s^2", "normal", 1.0, 0.5, 0.1, 5.0},
                      {"d", "s^2", "normal", 0.5, 0.5, 0.0, 5.0},
                      {"k", "1", "normal", 20.0, 10.0, 1.0, 100.0}};
  plant.states = {{"pos", "1", "position", "speed", "y", "", 1},
                  {"speed", "1/s", "velocity", "(abs(u) - d*speed*abs(speed) - k*sin(pos))/m", "0", "", 3}};
  return plant;
}

TEST(States, AreIntegratedAsTheMethodSays) {
  const auto plant = test::Program(Oscillator());
  EXPECT_EQ(plant->states().substeps(), 2) << "the finest of all";
  Reference reference;
  reference.x = {0.2, 0.0};
  std::vector<double> expected = {0.2};
  const DataPack pack = DescribedPack(
      *plant, 1,
      [](double t) {
        return PlantSample{{Drive(t)}, 0.2};
      },
      40, kDt);
  for (int n = 1; n < 40; ++n) {
    reference.Step(Drive(n * kDt), Drive((n + 1) * kDt));
    expected.push_back(reference.x[0]);
  }
  const Laid laid(*plant, pack, nullptr, {1.3, 0.8, 31.0});
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    const auto prediction = std::make_unique<PredictionTile>();
    kernels->predict(-1, *laid.data, laid.tile, prediction.get());
    for (std::size_t n = 0; n < 40; ++n)
      for (const std::size_t lane : {std::size_t{0}, std::size_t{31}})
        EXPECT_NEAR(prediction->value[n][lane], expected[n], 1e-13) << kernels->name << ", sample " << n;
    StateTile end, offset{};
    kernels->run_states(*laid.data, laid.tile, offset, &end, prediction.get());
    EXPECT_NEAR(end.value[0][7], reference.x[0], 1e-13);
    EXPECT_NEAR(end.value[1][7], reference.x[1], 1e-12);
    EXPECT_NEAR(prediction->value[39][7], expected[39], 1e-13);
  }
}

// As written 2^40 terms; a plant file must not keep its reader waiting.
TEST(States, APartOfARateThatManyUseIsMadeOnce) {
  PlantDescription chain = Oscillator();
  chain.lets = {{"a0", "pos/m"}};
  for (int i = 1; i <= 40; ++i) {
    const std::string& before = chain.lets.back().name;
    std::string text = "0.75*";
    text.append(before).append(" + 0.25*").append(before).append("*d/d");
    chain.lets.push_back({"a" + std::to_string(i), text});
  }
  chain.states[1].rate = "(u - d*speed)/m - k*a40";
  const auto plain = test::Program(Oscillator()), chained = test::Program(chain);
  const DataPack pack = DescribedPack(
      *plain, 1,
      [](double t) {
        return PlantSample{{Drive(t)}, 0.2};
      },
      40, kDt);
  const Laid one(*plain, pack, nullptr, {1.3, 0.8, 31.0}), other(*chained, pack, nullptr, {1.3, 0.8, 31.0});
  const auto expected = std::make_unique<PredictionTile>(), prediction = std::make_unique<PredictionTile>();
  simd::Best().predict(-1, *one.data, one.tile, expected.get());
  simd::Best().predict(-1, *other.data, other.tile, prediction.get());
  for (std::size_t n = 0; n < 40; ++n) EXPECT_NEAR(prediction->value[n][3], expected->value[n][3], 1e-12);
}

TEST(States, RatesThatAreNotLinearAreIntegratedStageByStage) {
  const auto plant = test::Program(Pendulum());
  const auto linear = test::Program(Oscillator());
  EXPECT_LT(2 * linear->states().step().size(), plant->states().step().size())
      << "all stages of a linear one are a sum of states and inputs, whose coefficients no sample changes";
  const DataPack pack = DescribedPack(
      *plant, 1,
      [](double t) {
        return PlantSample{{Drive(t)}, 0.2};
      },
      60, kDt);
  const Laid laid(*plant, pack, nullptr, {1.3, 0.8, 31.0});
  const auto prediction = std::make_unique<PredictionTile>();
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    Reference reference;
    reference.x = {0.2, 0.0};
    reference.substeps = 3;
    reference.rate = [](const std::array<double, 2>& s, double u) {
      return std::array<double, 2>{s[1], (std::fabs(u) - 0.8 * s[1] * std::fabs(s[1]) - 31.0 * std::sin(s[0])) / 1.3};
    };
    kernels->predict(-1, *laid.data, laid.tile, prediction.get());
    for (int n = 0; n < 60; ++n) {
      EXPECT_NEAR(prediction->value[static_cast<std::size_t>(n)][9], reference.x[0], 1e-12) << kernels->name << n;
      reference.Step(Drive((n + 1) * kDt), Drive((n + 2) * kDt));
    }
  }
}

TEST(States, SameBitsOnEveryFusedInstructionSet) {
  const auto sets = test::FusedKernels();
  if (sets.size() < 2) GTEST_SKIP() << "this CPU has one of them only";
  for (const PlantDescription& description : {Oscillator(), Pendulum()}) {
    const auto plant = test::Program(description);
    const DataPack pack = DescribedPack(
        *plant, 1,
        [](double t) {
          return PlantSample{{Drive(t)}, 0.2};
        },
        60, kDt);
    Laid laid(*plant, pack, nullptr, {1.3, 0.8, 31.0});
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t lane = 0; lane < kTileLanes; ++lane)
        laid.tile.value[d][lane] *= 1.0 + 0.013 * static_cast<double>(lane);
    const NoiseModel noise(NoiseSettings{.std = 0.1});
    alignas(64) std::array<double, kTileLanes> log_scale{}, score{}, first_score{}, one{};
    const auto first = std::make_unique<PredictionTile>(), other = std::make_unique<PredictionTile>();
    for (const simd::Kernels* kernels : sets) {
      const bool is_first = kernels == sets[0];
      kernels->predict(-1, *laid.data, laid.tile, is_first ? first.get() : other.get());
      auto& scored = is_first ? first_score : score;
      const auto scratch = std::make_unique<PredictionTile>();
      kernels->score(-1, noise, *laid.data, laid.tile, log_scale.data(), scratch.get(), scored.data());
      // Two tiles side by side, the second one turned round.
      ThetaPair two = {laid.tile, laid.tile};
      for (std::size_t d = 0; d < 3; ++d) std::reverse(two[1].value[d].begin(), two[1].value[d].end());
      alignas(64) std::array<double, 2 * kTileLanes> both_scale{}, both{};
      kernels->score_two(-1, noise, *laid.data, two, both_scale.data(), scratch.get(), both.data());
      kernels->score(-1, noise, *laid.data, two[1], log_scale.data(), scratch.get(), one.data());
      for (std::size_t lane = 0; lane < kTileLanes; ++lane) {
        EXPECT_TRUE(test::SameBits(both[lane], scored[lane])) << kernels->name << description.name << lane;
        EXPECT_TRUE(test::SameBits(both[kTileLanes + lane], one[lane])) << kernels->name << description.name << lane;
      }
      for (std::size_t lane = 0; !is_first && lane < kTileLanes; ++lane) {
        EXPECT_TRUE(test::SameBits(first_score[lane], score[lane])) << description.name;
        for (std::size_t n = 0; n < 60; ++n)
          ASSERT_TRUE(test::SameBits(first->value[n][lane], other->value[n][lane])) << description.name << n;
      }
    }
  }
}

/// Of a law that is a sum of states, and of one that is not; beside an uncertain start, with weights.
TEST(States, ScoresAreThoseOfThePredictions) {
  constexpr std::size_t kSamples = 61;
  PlantDescription bent = Pendulum();
  bent.law = "sin(pos)";
  for (const PlantDescription& description : {Oscillator(), Pendulum(), bent}) {
    const auto plant = test::Program(description);
    const DataPack pack = DescribedPack(
        *plant, 1,
        [](double t) {
          return PlantSample{{Drive(t)}, 0.2};
        },
        static_cast<int>(kSamples), kDt);
    Laid laid(*plant, pack, nullptr, {1.3, 0.8, 31.0});
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t lane = 0; lane < kTileLanes; ++lane)
        laid.tile.value[d][lane] *= 1.0 + 0.013 * static_cast<double>(lane);
    const auto fit = std::make_unique<StartFit>();
    fit->shrink = {0.3, 0.6};
    for (std::size_t n = 0; n < kSamples; ++n) {
      // A sine and a cosine over whole periods: orthonormal.
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(n) / kSamples, norm = std::sqrt(2.0 / kSamples);
      fit->direction[0][n] = norm * std::cos(angle);
      fit->direction[1][n] = norm * std::sin(angle);
    }
    laid.data->start_fit = fit.get();
    const NoiseModel noise(NoiseSettings{.std = 0.1});
    alignas(64) std::array<double, kTileLanes> log_scale{}, score{}, expected{};
    const auto law = std::make_unique<PredictionTile>(), half = std::make_unique<PredictionTile>();
    for (const int count : {0, 2}) {
      fit->count = count;
      for (const bool weighted : {false, true}) {
        laid.data->weighted = weighted;
        for (std::size_t n = 0; n < kSamples; ++n)
          laid.data->weight[n] = weighted ? 1.0 / (1.0 + 0.01 * static_cast<double>(n)) : 1.0;
        for (const simd::Kernels* kernels : test::RunnableKernels()) {
          kernels->predict(-1, *laid.data, laid.tile, law.get());
          kernels->log_likelihood(noise, *laid.data, *law, log_scale.data(), expected.data());
          kernels->predict_half(-1, *laid.data, laid.tile, half.get());
          for (std::size_t n = 0; n < kSamples; ++n)
            for (std::size_t lane = 0; lane < kTileLanes / 2; ++lane)
              ASSERT_TRUE(test::SameBits(half->value[n][lane], law->value[n][lane])) << kernels->name << n;
          kernels->score(-1, noise, *laid.data, laid.tile, log_scale.data(), half.get(), score.data());
          for (std::size_t lane = 0; lane < kTileLanes; ++lane)
            EXPECT_NEAR(score[lane], expected[lane], 1e-11 * std::fabs(expected[lane]))
                << kernels->name << description.law << count << weighted << lane;
        }
      }
    }
  }
}

TEST(States, APackThatGoesOnStartsOneIntervalBeforeItsFirstSample) {
  const auto plant = test::Program(Oscillator());
  const auto at = [](double t) { return PlantSample{{Drive(t)}, 0.7}; };
  const DataPack first = DescribedPack(*plant, 1, at, 30, kDt), second = DescribedPack(*plant, 2, at, 30, kDt);
  StateMemory memory;
  memory.known = true;
  memory.state = {0.1, -0.4};
  plant->Leave(*Laid(*plant, first, nullptr, {}).plant_pack, 30, &memory);
  Reference reference;
  reference.x = {0.1, -0.4};
  const Laid laid(*plant, second, &memory, {1.3, 0.8, 31.0});
  const auto prediction = std::make_unique<PredictionTile>();
  simd::Best().predict(-1, *laid.data, laid.tile, prediction.get());
  for (int n = 0; n < 30; ++n) {
    reference.Step(Drive((30 + n) * kDt), Drive((31 + n) * kDt));
    EXPECT_NEAR(prediction->value[static_cast<std::size_t>(n)][3], reference.x[0], 1e-13) << n;
  }
}

/// pos' = u / m: what a state adds up says what its input does between samples.
PlantDescription Sum(const char* between) {
  PlantDescription plant = Oscillator();
  plant.signals[0].unit = "kg m/s";
  plant.signals[0].between = between;
  plant.parameters = {{"m", "kg", "normal", 1.0, 0.5, 0.1, 5.0}};
  plant.states = {{"pos", "m", "position", "u/m", "y", "", 1}};
  return plant;
}

TEST(States, AnInputMayBeHeldOrSmoothBetweenSamples) {
  const auto drive = [](double t) { return 0.5 + t - 3.0 * t * t + 7.0 * t * t * t; };
  const auto integral = [](double t) { return 0.5 * t + t * t / 2.0 - t * t * t + 7.0 * t * t * t * t / 4.0; };
  const auto at = [&](double t) { return PlantSample{{drive(t)}, 0.0}; };
  for (const char* between : {"held", "smooth"}) {
    const auto plant = test::Program(Sum(between));
    const DataPack first = DescribedPack(*plant, 1, at, 20, kDt), second = DescribedPack(*plant, 2, at, 20, kDt);
    StateMemory memory;
    memory.known = true;
    memory.state = {3.0};
    plant->Leave(*Laid(*plant, first, nullptr, {}).plant_pack, 20, &memory);
    const Laid laid(*plant, second, &memory, {1.0});
    const auto prediction = std::make_unique<PredictionTile>();
    simd::Best().predict(-1, *laid.data, laid.tile, prediction.get());
    const bool held = std::string(between) == "held";
    double sum = 3.0;
    for (int n = 0; n < 20; ++n) {
      // Intervals at the ends of what is known have a parabola.
      const double from = (20 + n) * kDt, to = from + kDt;
      sum += held ? kDt * drive(from) : integral(to) - integral(from);
      EXPECT_NEAR(prediction->value[static_cast<std::size_t>(n)][5], sum, held ? 1e-13 : 5e-8) << between << n;
      if (!held && n > 0 && n < 19) {
        EXPECT_NEAR(
            prediction->value[static_cast<std::size_t>(n)][5] - prediction->value[static_cast<std::size_t>(n - 1)][5],
            integral(to) - integral(from), 1e-14)
            << "a cubic, exactly";
      }
    }
  }
}

TEST(States, AMeasuredOneStartsFromItsSignal) {
  PlantDescription description = Oscillator();
  description.states[0].measured_by = "y";
  const auto plant = test::Program(description);
  const DataPack pack = DescribedPack(
      *plant, 2,
      [](double t) {
        return PlantSample{{0.0}, t};
      },
      30, kDt);
  StateMemory memory;
  memory.known = true;
  memory.state = {100.0, 0.5};
  memory.point = {0.0, 0.25};  // u, y
  const Laid laid(*plant, pack, &memory, {1.3, 0.8, 31.0});
  const StateRun& run = laid.plant_pack->states;
  EXPECT_TRUE(run.carried) << "the speed goes on";
  EXPECT_EQ(run.value[0], 0.25) << "where the sample before measured it";
  EXPECT_EQ(run.value[1], 0.5);
  // Where all are measured nothing has to go on.
  description.signals.push_back({"v", "m/s", "velocity", ""});
  description.states[1].measured_by = "v";
  const auto measured = test::Program(description);
  const DataPack other = DescribedPack(
      *measured, 2,
      [](double t) {
        return PlantSample{{0.0, 3.0}, t};
      },
      30, kDt);
  const Laid laid_measured(*measured, other, &memory, {1.3, 0.8, 31.0});
  EXPECT_FALSE(laid_measured.plant_pack->states.carried);
  EXPECT_EQ(laid_measured.plant_pack->states.value[0], other.y[0]);
  EXPECT_EQ(laid_measured.plant_pack->states.value[1], 3.0);
}

TEST(States, AStartMayBeAParameter) {
  PlantDescription description = Oscillator();
  description.parameters.push_back({"x0", "m", "normal", 0.0, 1.0, -3.0, 3.0});
  description.states[0].start = "x0";
  const auto plant = test::Program(description);
  test::Rig rig(DescribedSettings(plant));
  test::ReferenceRun run;
  run.reference.x = {0.6, 0.0};
  for (std::int64_t seq = 1; seq <= 4; ++seq) {
    (void)rig.Step(DescribedPack(
        *plant, seq, [&](double t) { return run.At(t); }, 50, kDt));
    if (seq > 1) continue;  // the packs after it say nothing on how the first one began
    const MarginalSummary& x0 = rig.estimate().modes[0].marginal[3];
    EXPECT_NEAR(x0.ar_ap, 0.6, 5.0 * x0.sd);
    EXPECT_LT(x0.sd, 0.02);
  }
  const ModeEstimate& mode = rig.estimate().modes[0];
  for (std::size_t d = 0; d < 3; ++d)
    EXPECT_NEAR(mode.marginal[d].ar_ap, run.reference.theta[d], 5.0 * mode.marginal[d].sd);
}

TEST(States, ParametersOfAModeAreThatModesInRatesToo) {
  PlantDescription description;
  description.name = "tank";
  description.output = "y";
  description.signals = {{"u", "V", "drive", ""}, {"y", "V", "level", ""}};
  description.parameters = {{"c", "1/s", "normal", 1.0, 1.0, 0.0, 10.0}};
  description.parameters[0].per_mode = true;
  description.states = {{"level", "V", "level", "c*(u - level)", "y", "", 4}};
  description.modes = {{"filling", "u > 0", "level", "", false}, {"draining", "", "level", "", false}};
  description.noise.std = 0.01;
  const auto plant = test::Program(description);
  ASSERT_EQ(plant->info().num_modes, 1) << "one trajectory, whatever the mode";
  ASSERT_EQ(plant->info().num_parameters, 2);
  test::Rig rig(DescribedSettings(plant));
  test::GaussianNoise noise(0.01);
  double level = 0.5;
  for (std::int64_t seq = 1; seq <= 10; ++seq)
    (void)rig.Step(DescribedPack(
        *plant, seq,
        [&](double t) {
          const double y = level + noise();
          constexpr int kFine = 100;
          for (int i = 0; i < kFine; ++i) {
            const double u = 2.0 * std::sin(3.0 * (t + (i + 0.5) / kFine * kDt));
            level = u + (level - u) * std::exp(-kDt / kFine * (u > 0.0 ? 3.0 : 0.7));
          }
          return PlantSample{{2.0 * std::sin(3.0 * t)}, y};
        },
        50, kDt));
  const ModeEstimate& mode = rig.estimate().modes[0];
  EXPECT_NEAR(mode.marginal[0].ar_ap, 3.0, 5.0 * mode.marginal[0].sd);
  EXPECT_NEAR(mode.marginal[1].ar_ap, 0.7, 5.0 * mode.marginal[1].sd);
  EXPECT_LT(mode.marginal[0].sd, 0.05);
  EXPECT_LT(mode.marginal[1].sd, 0.05);
}

TEST(States, AGapInThePacksStartsAnew) {
  const auto plant = test::Program(Oscillator());
  test::Rig rig(DescribedSettings(plant));
  const auto pack = [&](std::int64_t seq) {
    return DescribedPack(
        *plant, seq,
        [](double) {
          return PlantSample{{0.0}, 0.3};
        },
        50, kDt);
  };
  (void)rig.Step(pack(1));
  EXPECT_FALSE(rig.result->effects.described.states.carried);
  (void)rig.Step(pack(2));
  EXPECT_TRUE(rig.result->effects.described.states.carried);
  (void)rig.Step(pack(4));
  EXPECT_FALSE(rig.result->effects.described.states.carried);
  EXPECT_FALSE(rig.result->effects.described.states.given[0]) << "the start of the file";
  rig.estimator.Reset();
  (void)rig.Step(pack(5));
  EXPECT_FALSE(rig.result->effects.described.states.carried);
}

}  // namespace
}  // namespace armcmc::states_test
