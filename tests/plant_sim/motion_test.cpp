#include "armcmc/plant_sim/motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "hunt_crossley/plant.hpp"

namespace armcmc::plant_sim::motion_test {
namespace {

constexpr double kDt = 1e-3;
constexpr int kSamples = 10'000;

Options MotionSettings(const std::string& program, double depth = 1.0, double pace = 1.0, double band_hz = 14.0) {
  Options options(HuntCrossleyFamily().options);
  options.Set("tracking", std::string("prescribed"));
  options.Set("program", program);
  options.Set("depth", depth);
  options.Set("pace", pace);
  options.Set("band_hz", band_hz);
  return options;
}

std::vector<Motion::State> Follow(const Options& options, std::uint64_t seed, double dt = kDt, int samples = kSamples) {
  Motion motion(options, seed);
  std::vector<Motion::State> states;
  for (int i = 0; i <= samples; ++i) states.push_back(motion.At(i * dt));
  return states;
}

double Deepest(const std::vector<Motion::State>& states) {
  double deepest = -1e9;
  for (const Motion::State& state : states) deepest = std::max(deepest, state.x);
  return deepest;
}

double ContactShare(const std::vector<Motion::State>& states) {
  const auto contact = std::count_if(states.begin(), states.end(), [](const auto& state) { return state.x >= 0.0; });
  return static_cast<double>(contact) / static_cast<double>(states.size());
}

/// Amplitude of a frequency in the position, by a Hann window.
double Line(const std::vector<Motion::State>& states, double hz) {
  std::complex<double> sum;
  double weights = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(states.size());
    const double weight = 1.0 - std::cos(2.0 * std::numbers::pi * share);
    sum += weight * states[i].x * std::polar(1.0, -2.0 * std::numbers::pi * hz * kDt * static_cast<double>(i));
    weights += weight;
  }
  return 2.0 * std::abs(sum) / weights;
}

// What holds for the splines holds for every path; the rich one has them all, jumps included.

TEST(Motion, HasTheVelocityThatIsTheDerivativeOfThePosition) {
  // Fourth-order differences of a four times differentiable path over 0.1 ms: (2 pi 40 Hz 1e-4)^4 / 30 = 1e-8.
  constexpr double kFine = 1e-4;
  const std::vector<Motion::State> states = Follow(MotionSettings("rich"), 5, kFine, 30'000);
  double fastest = 0.0, worst = 0.0;
  for (std::size_t i = 2; i + 2 < states.size(); ++i) {
    const double slope =
        (8.0 * (states[i + 1].x - states[i - 1].x) - (states[i + 2].x - states[i - 2].x)) / (12.0 * kFine);
    fastest = std::max(fastest, std::abs(states[i].v));
    worst = std::max(worst, std::abs(slope - states[i].v));
  }
  EXPECT_GT(fastest, 0.1);
  EXPECT_LT(worst, 1e-6 * fastest);
}

TEST(Motion, ScalesWithDepthAndPace) {
  const std::vector<Motion::State> metre = Follow(MotionSettings("rich"), 5);
  const std::vector<Motion::State> millimetre = Follow(MotionSettings("rich", 1e-3), 5);
  // Twice as fast through twice the band is the same motion in half the time.
  const std::vector<Motion::State> fast = Follow(MotionSettings("rich", 1.0, 2.0, 28.0), 5, kDt / 2);
  for (std::size_t i = 0; i < metre.size(); ++i) {
    ASSERT_NEAR(millimetre[i].x, 1e-3 * metre[i].x, 1e-15) << i;
    ASSERT_NEAR(millimetre[i].v, 1e-3 * metre[i].v, 1e-12) << i;
    ASSERT_NEAR(fast[i].x, metre[i].x, 1e-9) << i;
    ASSERT_NEAR(fast[i].v, 2.0 * metre[i].v, 1e-6) << i;
  }
}

TEST(Motion, DoesNotDependOnTheSampling) {
  const std::vector<Motion::State> fine = Follow(MotionSettings("rich"), 5);
  const std::vector<Motion::State> coarse = Follow(MotionSettings("rich"), 5, 50 * kDt, kSamples / 50);
  for (std::size_t i = 0; i < coarse.size(); ++i) ASSERT_NEAR(coarse[i].x, fine[50 * i].x, 1e-10) << i;
}

TEST(Motion, HasNothingFarAboveTheBandLimit) {
  const std::vector<Motion::State> states = Follow(MotionSettings("rich"), 5);
  double below = 0.0, above = 0.0;
  for (double hz = 0.1; hz < 10.0; hz += 0.1) below = std::max(below, Line(states, hz));
  for (double hz = 60.0; hz < 120.0; hz += 1.0) above = std::max(above, Line(states, hz));
  EXPECT_LT(above, 1e-3 * below);
}

TEST(Motion, PressesAsDeepAsAskedForAndMakesTheContactThatItsNamePromises) {
  const auto share = [](const char* program) { return ContactShare(Follow(MotionSettings(program), 1)); };
  for (const char* program : {"slow_triangle", "fast_taps", "step_hold", "taps_of_depths"}) {
    EXPECT_NEAR(Deepest(Follow(MotionSettings(program), 1)), 1.0, 0.05) << program;
    EXPECT_GT(share(program), 0.5) << program;
    EXPECT_LT(share(program), 0.95) << program;
  }
  for (const char* program : {"sine", "contact_chirp"}) EXPECT_EQ(share(program), 1.0) << program;
  for (const char* program : {"free_air", "free_air_chirp"}) EXPECT_EQ(share(program), 0.0) << program;
}

TEST(Motion, ASineIsASineDampedByTheBandLimitAlone) {
  // One cycle a second through sinc(f h)^6 with sinc(14 Hz h)^6 = 1/sqrt(2), half a unit above the surface.
  const auto gain = [](double hz) {
    const double u = std::numbers::pi * 0.18634 / 14.0 * hz;
    return std::pow(std::sin(u) / u, 6);
  };
  EXPECT_NEAR(gain(14.0), std::sqrt(0.5), 1e-4);
  const std::vector<Motion::State> states = Follow(MotionSettings("sine"), 1);
  EXPECT_NEAR(Line(states, 1.0), 0.31 * gain(1.0), 1e-6);
  EXPECT_LT(Line(states, 3.0), 1e-6);
  // Zero phase: the path starts two knots before t = 0.
  const double lead = 2.0 * 0.18634 / 14.0;
  for (int i = 0; i < 1000; i += 10)
    ASSERT_NEAR(states[static_cast<std::size_t>(i)].x,
                0.5 + 0.31 * gain(1.0) * std::sin(2.0 * std::numbers::pi * (kDt * i + lead)), 1e-6);
}

TEST(Motion, AChirpSweepsUpAndDownAgainWithoutAJump) {
  const std::vector<Motion::State> states = Follow(MotionSettings("contact_chirp"), 1, kDt, 3 * kSamples);
  const auto crossings = [&states](double from, double to) {
    int count = 0;
    for (auto i = static_cast<std::size_t>(from / kDt); i < static_cast<std::size_t>(to / kDt); ++i)
      count += (states[i].x < 0.6) != (states[i + 1].x < 0.6);
    return count;
  };
  const auto fastest = [&states](double from, double to) {
    double speed = 0.0;
    for (auto i = static_cast<std::size_t>(from / kDt); i < static_cast<std::size_t>(to / kDt); ++i)
      speed = std::max(speed, std::abs(states[i].v));
    return speed;
  };
  // Ten seconds from 0.3 to 8 Hz, equally long in every octave, are 7.7 10 / ln(8 / 0.3) cycles.
  const double cycles = 7.7 * 10.0 / std::log(8.0 / 0.3);
  for (const double begin : {0.0, 10.0, 20.0}) EXPECT_NEAR(crossings(begin, begin + 10.0), 2.0 * cycles, 2.0) << begin;
  EXPECT_LT(crossings(0.0, 2.0), 4);
  EXPECT_GT(crossings(8.0, 10.0), 20);
  EXPECT_GT(crossings(10.0, 12.0), 20);
  EXPECT_LT(crossings(18.0, 20.0), 4);
  EXPECT_NEAR(fastest(9.9, 10.1), fastest(9.5, 9.9), 0.1 * fastest(9.5, 9.9));
  EXPECT_LT(fastest(19.0, 21.0), 0.1 * fastest(9.9, 10.1));
}

TEST(Motion, RichIsAnotherMotionForEverySeedAndTheSameForOne) {
  const std::vector<Motion::State> a = Follow(MotionSettings("rich"), 1), again = Follow(MotionSettings("rich"), 1);
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i].x, again[i].x);
  for (std::uint64_t seed = 2; seed <= 40; ++seed) {
    const std::vector<Motion::State> b = Follow(MotionSettings("rich"), seed);
    double distance = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) distance += std::abs(a[i].x - b[i].x) / kSamples;
    EXPECT_GT(distance, 0.1) << seed;
    EXPECT_GT(ContactShare(b), 0.5) << seed;
    EXPECT_LT(ContactShare(b), 0.99) << seed;
    EXPECT_GT(Deepest(b), 0.6) << seed;
    EXPECT_LT(Deepest(b), 1.3) << seed;
  }
}

TEST(Motion, StrokesGoInAndOutAtConstantSpeedsOfTheirOwn) {
  const std::vector<Motion::State> states = Follow(MotionSettings("strokes"), 3);
  std::vector<double> speeds;  // of stretches of 50 samples without acceleration
  int steady = 0, along = 0;
  for (std::size_t i = 1; i < states.size(); ++i) {
    const bool same = std::abs(states[i].v - states[i - 1].v) < 1e-9;
    steady += same ? 1 : 0;
    along = same ? along + 1 : 0;
    if (along == 50 && std::abs(states[i].v) > 0.1) speeds.push_back(states[i].v);
  }
  EXPECT_GT(steady, kSamples / 2);
  ASSERT_GE(speeds.size(), 6u);
  for (std::size_t i = 1; i < speeds.size(); ++i) {
    EXPECT_LT(speeds[i] * speeds[i - 1], 0.0) << "in, then out";
    EXPECT_GT(std::abs(std::abs(speeds[i]) - std::abs(speeds[i - 1])), 1e-6);
    EXPECT_GT(std::abs(speeds[i]), 0.69);
    EXPECT_LT(std::abs(speeds[i]), 4.01);
  }
  EXPECT_GT(ContactShare(states), 0.4);
  EXPECT_LT(ContactShare(states), 0.95);
}

/// A recorded ramp of a unit a second, `seconds` long.
Options RecordedRamp(double seconds, double start_s) {
  const auto ramp = std::make_shared<Series>();
  ramp->interval_s = 0.01;
  for (int i = 0; i <= std::lround(seconds / ramp->interval_s); ++i) ramp->values.push_back(i * ramp->interval_s);
  Options options = MotionSettings("recorded");
  options.Set("recording", std::shared_ptr<const Series>(ramp));
  options.Set("recording_start_s", start_s);
  return options;
}

TEST(Motion, ARecordingIsFollowedFromWhereItIsToBeginAndRunsBackFromItsEnd) {
  const double lead = 2.0 * 0.18634 / 14.0, rounded = 0.05;  // s; the end of a ramp is smoothed
  const std::vector<Motion::State> states = Follow(RecordedRamp(4.0, 1.0), 1);
  for (int i = 0; i <= kSamples; i += 7) {
    const double way = std::fmod(1.0 + lead + kDt * i, 8.0), x = way <= 4.0 ? way : 8.0 - way;
    if (std::abs(way - 4.0) < rounded || way < rounded || way > 8.0 - rounded) continue;
    ASSERT_NEAR(states[static_cast<std::size_t>(i)].x, x, 1e-9) << i;
    ASSERT_NEAR(states[static_cast<std::size_t>(i)].v, way <= 4.0 ? 1.0 : -1.0, 1e-9) << i;
  }
}

TEST(Motion, ARecordingAndItsProgramNeedEachOther) {
  EXPECT_THROW(Motion(MotionSettings("recorded"), 1), std::invalid_argument);
  Options options = RecordedRamp(4.0, 0.0);
  options.Set("program", std::string("rich"));
  EXPECT_THROW(Motion(options, 1), std::invalid_argument);
}

TEST(Motion, ThePlantFollowsItExactly) {
  const Schedule schedule({4.0, 0.8, 1.5}, {});
  const Options options = MotionSettings("rich", 0.3);
  HuntCrossleyPlant plant({schedule, options, kDt, 9});
  Motion motion(options, 9);
  for (int i = 0; i <= kSamples; ++i) {
    PlantSample sample;
    plant.Advance(&sample);
    const Motion::State state = motion.At(i * kDt);
    ASSERT_EQ(sample.inputs[0], state.x);
    ASSERT_EQ(sample.inputs[1], state.v);
    ASSERT_EQ(sample.mode, state.x >= 0.0 ? HuntCrossleyPlant::kContact : HuntCrossleyPlant::kFree);
    const double force = state.x >= 0.0 ? std::pow(state.x, 1.5) * (4.0 + 0.8 * state.v) : 0.0;
    ASSERT_NEAR(sample.output, force, 1e-14);
  }
}

}  // namespace
}  // namespace armcmc::plant_sim::motion_test
