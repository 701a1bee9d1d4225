// Functions with memory of what is sampled, against their definitions.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/kernel_sets.hpp"
#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::remembered_test {
namespace {

using test::DescribedPack;
using test::PlantSample;

constexpr double kDt = 0.01;
constexpr int kSamples = 40, kPacks = 3;
constexpr double kGain = 1.7, kTau = 0.083, kLate = 0.0537;

double Input(int n) { return std::sin(0.31 * n) + (n % 17 < 8 ? 0.6 : -0.2); }

/// One input, one output, three parameters, of which tau and late are times.
PlantDescription Late(const std::string& law) {
  PlantDescription plant;
  plant.name = "late";
  plant.output = "y";
  plant.law = law;
  plant.signals = {{"u", "1", "drive", ""}, {"y", "1", "position", ""}};
  plant.parameters = {{"K", "1", "normal", 1.0, 1.0},
                      {"tau", "s", "lognormal", 0.1, 1.0, 0.01, 1.0},
                      {"late", "s", "normal", 0.05, 0.05, 0.0, 0.2}};
  plant.noise.std = 0.01;
  return plant;
}

/// What the law says at every sample of packs that follow each other, for the parameters K, tau, late.
std::vector<double> Predicted(const PlantProgram& plant, const simd::Kernels& kernels, int packs = kPacks) {
  std::vector<double> values;
  expression::FeatureMemory memory;
  StateMemory before;
  const auto pack_of_plant = std::make_unique<PlantPack>();
  const auto data = std::make_unique<ModeData>();
  const auto law = std::make_unique<PredictionTile>();
  ThetaTile theta{};
  const double sampled[] = {kGain, std::log(kTau), kLate};
  for (std::size_t d = 0; d < 3; ++d) theta.value[d].fill(sampled[d]);
  for (int k = 1; k <= packs; ++k) {
    const DataPack pack = DescribedPack(
        plant, k,
        [](double t) {
          return PlantSample{{Input(static_cast<int>(std::lround(t / kDt)))}, 0.0};
        },
        kSamples, kDt);
    EXPECT_TRUE(plant.Prepare(pack, &memory, k > 1 ? &before : nullptr, pack_of_plant.get()));
    plant.Fill(*pack_of_plant, kSamples, 0, data.get());
    data->weighted = false;
    StateTile end{};
    if (plant.states().size() > 0) {
      kernels.run_states(*data, theta, StateTile{}, &end, law.get());
    } else {
      kernels.predict(-1, *data, theta, law.get());
    }
    for (std::size_t n = 0; n < kSamples; ++n) values.push_back(law->value[n][5]);
    plant.Leave(*pack_of_plant, kSamples, &before);
    before.known = true;
    for (std::size_t s = 0; s < kMaxStates; ++s) before.state[s] = end.value[s][5];
  }
  return values;
}

/// u at a place between samples, that of the first one before it.
double InputAt(double place) {
  const double at = std::fmax(place, 1.0);
  const int n = static_cast<int>(std::floor(at));
  return Input(n) + (at - n) * (Input(n + 1) - Input(n));
}

/// A low pass of input(n), n from 1, exact for what is linear between samples.
std::vector<double> Lowpass(const std::function<double(int)>& input, double start) {
  std::vector<double> y{start};
  const double decay = std::exp(-kDt / kTau), mean = (1.0 - decay) * kTau / kDt;
  for (int n = 2; n <= kPacks * kSamples; ++n)
    y.push_back(y.back() * decay + input(n - 1) * (mean - decay) + input(n) * (1.0 - mean));
  return y;
}

std::vector<double> Lowpass(const std::function<double(int)>& input) { return Lowpass(input, input(1)); }

void ExpectLaw(const PlantDescription& description, const std::function<double(int)>& expected, double near,
               int packs = kPacks) {
  const auto plant = test::Program(description);
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    const std::vector<double> values = Predicted(*plant, *kernels, packs);
    for (int n = 1; n <= packs * kSamples; ++n)
      ASSERT_NEAR(values[static_cast<std::size_t>(n - 1)], expected(n), near)
          << description.law << ", " << kernels->name << ", sample " << n;
  }
}

TEST(Remembered, ADelayThatIsSampledLooksItsSignalUp) {
  ExpectLaw(
      Late("K*delay(u, late) + 1e-300*tau/late"), [](int n) { return kGain * InputAt(n - kLate / kDt); }, 1e-12);
}

// More packs than the line is long, twice over.
TEST(Remembered, ALongDelayIsLookedUpThoughItsLineIsFull) {
  ExpectLaw(
      Late("K*delay(u, 150*late) + 1e-300*tau/late"), [](int n) { return kGain * InputAt(n - 150.0 * kLate / kDt); },
      1e-12, 60);
}

TEST(Remembered, FurtherBackThanTheLineHasNoValue) {
  const auto plant = test::Program(Late("K*delay(u, 200*late) + 1e-300*tau/late"));
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    const std::vector<double> values = Predicted(*plant, *kernels, 60);
    EXPECT_EQ(values[10], kGain * Input(1)) << kernels->name;
    EXPECT_TRUE(std::isnan(values.back())) << kernels->name;
  }
}

TEST(Remembered, AChainInWhichEveryLinkIsUsedTwiceIsWalkedOnce) {
  PlantDescription chain = Late("delay(a60, late) + 1e-300*tau/late");
  chain.lets = {{"a0", "K*u"}};
  for (int i = 1; i <= 60; ++i) {
    const std::string before = chain.lets.back().name;
    std::string text = "0.5*";
    text.append(before).append(" + 0.5*min(").append(before).append(", 9)");
    chain.lets.push_back({"a" + std::to_string(i), text});
  }
  ExpectLaw(
      chain, [](int n) { return kGain * InputAt(n - kLate / kDt); }, 1e-12);
}

TEST(Remembered, ADelayOfSomethingSampledIsThatOfItsSignals) {
  ExpectLaw(
      Late("delay(K*u^2 + late*u/tau, 0.03)"),
      [](int n) {
        const double u = InputAt(n - 3);
        return kGain * u * u + kLate * u / kTau;
      },
      1e-12);
  ExpectLaw(
      Late("previous(K*u) + 1e-300*late/tau"), [](int n) { return kGain * Input(n > 1 ? n - 1 : 1); }, 1e-12);
}

TEST(Remembered, ALowPassOfSomethingSampledIsExact) {
  const std::vector<double> y = Lowpass(Input);
  ExpectLaw(
      Late("lowpass(K*u, tau) + 1e-300*late/tau"), [&](int n) { return kGain * y[static_cast<std::size_t>(n - 1)]; },
      1e-12);
}

TEST(Remembered, ADelayedLowPassIsOneOfADelayedSignal) {
  const std::vector<double> y = Lowpass([](int n) { return InputAt(n - kLate / kDt); });
  ExpectLaw(
      Late("K*delay(lowpass(u, tau), late)"), [&](int n) { return kGain * y[static_cast<std::size_t>(n - 1)]; }, 1e-12);
}

TEST(Remembered, AnIntegralOfSomethingSampled) {
  double sum = 0.0;
  std::vector<double> expected{0.0};
  for (int n = 2; n <= kPacks * kSamples; ++n)
    expected.push_back(sum += 0.5 * kDt * (Input(n - 1) * Input(n - 1) + Input(n) * Input(n)));
  ExpectLaw(
      Late("integral(K*u*u)/tau + 1e-300*late/tau"),
      [&](int n) { return kGain * expected[static_cast<std::size_t>(n - 1)] / kTau; }, 1e-11);
}

// Which is what a first-order lag with dead time is. Its steps are short enough to be as good as the exact ones.
TEST(Remembered, ARateMayHaveADeadTime) {
  const std::vector<double> y = Lowpass([](int n) { return InputAt(n - kLate / kDt); });
  for (const char* time : {"late", "0.0537"}) {
    PlantDescription plant = Late("T + 1e-300*late/tau");
    plant.states = {{"T", "1", "", std::string("(K*delay(u, ") + time + ") - T)/tau", "K*u", "", 10}};
    ExpectLaw(
        plant, [&](int n) { return kGain * y[static_cast<std::size_t>(n - 1)]; }, 1e-8);
  }
}

/// T' = (K u - T) / tau from a start that is no rest.
PlantDescription DelayedState(const std::string& law) {
  PlantDescription plant = Late(law + " + 1e-300*late/tau");
  plant.states = {{"T", "1", "", "(K*u - T)/tau", "0", "", 10}};
  return plant;
}

// It stays at its start until that is so long ago, in whichever pack.
TEST(Remembered, ADelayedStateIsTheStateSomeTimeAgo) {
  const std::vector<double> y = Lowpass(Input, 0.0);
  const auto late = [&](int samples) {
    return [&y, samples](int n) { return kGain * y[static_cast<std::size_t>(std::max(n - samples, 1) - 1)]; };
  };
  ExpectLaw(DelayedState("delay(T, 0.05)"), late(5), 1e-7);
  ExpectLaw(DelayedState("delay(T, 0.5)"), late(50), 1e-7);
  ExpectLaw(DelayedState("previous(T)"), late(1), 1e-7);
  ExpectLaw(
      DelayedState("T - delay(T, 0.05) + delay(T^2, 0.05)"),
      [&](int n) {
        const double x = late(5)(n);
        return late(0)(n) - x + x * x;
      },
      1e-7);
}

TEST(Remembered, ADelayOfAStateMayBeSampled) {
  const std::vector<double> y = Lowpass(Input, 0.0);
  // What is linear between samples, of a state that is not.
  const auto at = [&](double place) {
    const double from = std::clamp(place, 1.0, static_cast<double>(y.size()));
    const auto n = std::min(static_cast<std::size_t>(from), y.size() - 1);
    return y[n - 1] + (from - static_cast<double>(n)) * (y[n] - y[n - 1]);
  };
  ExpectLaw(
      DelayedState("delay(T, late)"), [&](int n) { return kGain * at(n - kLate / kDt); }, 0.03);
}

PlantDescription HeldInput(const std::string& law) {
  PlantDescription plant = Late(law + " + 1e-300*late/tau");
  plant.signals[0].between = "held";
  return plant;
}

/// A low pass of what stays input(n) until the next sample.
std::vector<double> HeldLowpass(const std::function<double(int)>& input) {
  std::vector<double> y{input(1)};
  const double decay = std::exp(-kDt / kTau);
  for (int n = 2; n <= kPacks * kSamples; ++n) y.push_back(y.back() * decay + input(n - 1) * (1.0 - decay));
  return y;
}

double InputOf(int n) { return Input(std::max(n, 1)); }
/// Mean of the input that is held and comes kLate later, over the interval that begins at n.
double LateMean(int n) {
  const double part = kLate / kDt - 5.0;
  return part * InputOf(n - 6) + (1.0 - part) * InputOf(n - 5);
}

TEST(Remembered, WhatIsHeldBetweenSamplesIsRememberedAsHeld) {
  const std::vector<double> y = HeldLowpass(Input), late = HeldLowpass(LateMean);
  const auto of = [](const std::vector<double>& values) {
    return [&values](int n) { return kGain * values[static_cast<std::size_t>(n - 1)]; };
  };
  ExpectLaw(HeldInput("K*lowpass(u, 0.083)"), of(y), 1e-12);
  ExpectLaw(HeldInput("lowpass(K*u, tau)"), of(y), 1e-12);
  ExpectLaw(HeldInput("K*lowpass(delay(u, 0.0537), 0.083)"), of(late), 1e-12);
  ExpectLaw(HeldInput("lowpass(K*delay(u, 0.0537), tau)"), of(late), 1e-12);
  std::vector<double> sum{0.0};
  for (int n = 2; n <= kPacks * kSamples; ++n) sum.push_back(sum.back() + kDt / kTau * Input(n - 1) * Input(n - 1));
  ExpectLaw(HeldInput("K*integral(u^2)/tau"), of(sum), 1e-12);
  ExpectLaw(HeldInput("integral(K*u^2)/tau"), of(sum), 1e-11);
  for (const char* tau : {"filter", "tau"}) {
    PlantDescription plant = HeldInput("T");
    plant.constants = {{"filter", kTau, "s"}};
    plant.states = {{"T", "1", "", std::string("(K*delay(u, 0.0537) - T)/") + tau, "K*u", "", 10}};
    ExpectLaw(plant, of(late), 1e-8);
  }
}

// At a sample it is what was held then; by a time that is sampled, the same on average.
TEST(Remembered, ADelayOfWhatIsHeldIsHeld) {
  ExpectLaw(
      HeldInput("K*delay(u, 0.0537)"), [](int n) { return kGain * InputOf(n - 6); }, 1e-12);
  ExpectLaw(
      HeldInput("delay(K*u, 0.0537)"), [](int n) { return kGain * InputOf(n - 6); }, 1e-12);
  ExpectLaw(
      HeldInput("K*delay(u, 0.05)"), [](int n) { return kGain * InputOf(n - 5); }, 1e-12);
  ExpectLaw(
      HeldInput("K*delay(u, late)"), [](int n) { return kGain * InputAt(n - kLate / kDt - 0.5); }, 1e-12);
  PlantDescription plant = HeldInput("T");
  plant.states = {{"T", "1", "", "(K*delay(u, late) - T)/tau", "K*u", "", 10}};
  const std::vector<double> late = HeldLowpass(LateMean);
  ExpectLaw(
      plant, [&](int n) { return kGain * late[static_cast<std::size_t>(n - 1)]; }, 1e-8);
}

// Where nobody measured how a run begins, the late state begins as openly as the state does; a low pass has its input.
TEST(Remembered, ALateStateBeginsAsTheStateDoes) {
  const auto plant = test::Program(DelayedState("delay(T, 0.05) + lowpass(T, tau)"));
  ASSERT_EQ(plant->states().size(), 3);
  EXPECT_TRUE(plant->states().has_given_start(0));
  EXPECT_TRUE(plant->states().has_given_start(1));
  EXPECT_FALSE(plant->states().has_given_start(2));
}

void ExpectLawError(const PlantDescription& plant, const std::string& key, const std::string& text) {
  try {
    (void)test::Program(plant);
    FAIL() << "no error";
  } catch (const PlantError& error) {
    EXPECT_EQ(error.key(), key);
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
  }
}

TEST(Remembered, WhatCannotBeLookedUpSaysWhatToDo) {
  PlantDescription measured = DelayedState("delay(T, late)");
  measured.states[0].measured_by = "y";
  ExpectLawError(measured, "law", "of a state that is measured: take it of its signal");
  PlantDescription feedback = DelayedState("T");
  feedback.states[0].rate = "(K*u - delay(T, 0.05))/tau";
  ExpectLawError(feedback, "states.T.rate", "a state that moves itself late");
  PlantDescription many = Late("delay(a, 0.05) + 1e-300*late/tau");
  for (const char* name : {"a", "b", "c", "d", "e"})
    many.states.push_back({name, "1", "", std::string("(K*u - a - b - c - d - e - ") + name + ")/tau", "0", "", 1});
  ExpectLawError(many, "law", "needs more than 8 states");
}

}  // namespace
}  // namespace armcmc::remembered_test
