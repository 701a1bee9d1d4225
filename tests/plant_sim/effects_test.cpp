// Effects against what their formulas say, on motions made for them: those that the estimator knows no model of, and
// what the comparison with its models (model_file_test) does not see.

#include "armcmc/plant_sim/effects/effect.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/plant_sim/effects/effect_chain.hpp"

namespace armcmc::plant_sim::effects_test {
namespace {

constexpr double kDt = 1e-3, kDuration = 10.0;
constexpr double kK = 4.0, kB = 2.0, kP = 1.5;

double Law(double x, double v, double k = kK) { return x >= 0.0 ? std::pow(x, kP) * (k + kB * v) : 0.0; }

/// The law without motion of its own: tests hand it the samples.
class LawOnly final : public Plant {
 public:
  void Advance(PlantSample*) noexcept override {}
  [[nodiscard]] Theta Truth(int, double) const noexcept override { return {kK, kB, kP}; }
  [[nodiscard]] double Predict(const Theta& theta, const PlantSample& sample) const noexcept override {
    return Law(sample.inputs[0], sample.inputs[1], theta[0]);
  }
  [[nodiscard]] double Target(const PlantSample& sample) const noexcept override { return sample.output; }
};

const EffectSpec& Spec(const std::string& name, const std::string& variant) {
  for (const EffectSpec& spec : EffectRegistry(*FindPlantFamily("hunt_crossley")))
    if (spec.name == name && spec.variant == variant) return spec;
  throw std::out_of_range(name + ":" + variant);
}

struct Motion {
  std::function<double(double)> x, v;
};

const Motion kSine{[](double t) { return 0.1 + 0.3 * std::sin(3.0 * t); },
                   [](double t) { return 0.9 * std::cos(3.0 * t); }};

/// Runs an effect over a motion.
class Bench {
 public:
  Bench(const std::string& name, const std::string& variant, std::vector<double> values, Motion motion,
        const Gate& gate = {})
      : motion_(std::move(motion)),
        chain_({HiddenEffect{&Spec(name, variant), std::move(values), gate, 0.0}}, {kDt, kDuration}, &law_) {}

  struct Point {
    double t, x, v, base, seen;
  };
  /// The next sample. What is measured of the motion stays the motion, to the bit.
  Point Next() {
    PlantSample sample;
    sample.t_s = kDt * static_cast<double>(k_++);
    const double x = motion_.x(sample.t_s), v = motion_.v(sample.t_s);
    sample.inputs = {x, v, 0.0, 0.0};
    sample.mode = x >= 0.0 ? 0 : 1;
    sample.output = Law(x, v);
    const PlantSample& seen = chain_.Apply(sample);
    EXPECT_EQ(seen.inputs, sample.inputs);
    EXPECT_EQ(seen.t_s, sample.t_s);
    EXPECT_EQ(seen.mode, sample.mode);
    return {sample.t_s, x, v, sample.output, seen.output};
  }
  Point At(double t) {
    Point point = Next();
    while (point.t < t - kDt / 2) point = Next();
    return point;
  }

 private:
  LawOnly law_;
  Motion motion_;
  EffectChain chain_;
  int k_ = 0;
};

/// Runs 10 s of the sine and compares what is seen with what the formula says.
void ExpectSeen(const std::string& name, const std::string& variant, const std::vector<double>& values,
                const std::function<double(const Bench::Point&)>& formula, double tolerance = 1e-12, int skip = 0) {
  Bench bench(name, variant, values, kSine);
  double worst = 0.0, most = 0.0;
  for (int i = 0; i < 10'000; ++i) {
    const Bench::Point point = bench.Next();
    if (i < skip) continue;
    worst = std::max(worst, std::abs(point.seen - formula(point)));
    most = std::max(most, std::abs(point.seen - point.base));
  }
  EXPECT_LT(worst, tolerance) << name << ":" << variant;
  EXPECT_GT(most, 1e-3) << name << ":" << variant << " does nothing";
}

double Sign(double v) { return v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0; }

TEST(Effects, MemorylessOnesFollowTheirFormula) {
  using P = Bench::Point;
  ExpectSeen("force_drift", "exponential", {0.5, 2.0},
             [](const P& p) { return p.base + 0.5 * (1.0 - std::exp(-p.t / 2.0)); });
  ExpectSeen("coulomb_friction", "sign", {0.2}, [](const P& p) { return p.base + 0.2 * Sign(p.v); });
  ExpectSeen("coulomb_friction", "stribeck", {0.2, 0.05, 0.5, 0.1}, [](const P& p) {
    return p.base + 0.2 * (1.0 + 0.5 * std::exp(-std::pow(p.v / 0.1, 2.0))) * std::tanh(p.v / 0.05);
  });
  ExpectSeen("quadratic_drag", "quadratic", {0.4}, [](const P& p) { return p.base + 0.4 * p.v * std::abs(p.v); });
  ExpectSeen("periodic_disturbance", "square", {0.3, 7.0, 1.0},
             [](const P& p) { return p.base + 0.3 * Sign(std::sin(2.0 * std::numbers::pi * 7.0 * p.t + 1.0)); });
  ExpectSeen("spatial_ripple", "sine", {0.3, 0.05, 1.0}, [](const P& p) {
    return p.base + (p.x >= 0.0 ? 0.3 * std::sin(2.0 * std::numbers::pi * p.x / 0.05 + 1.0) : 0.0);
  });
  // A material that would pull is none.
  ExpectSeen("stiffness_drift", "linear", {-2.0, 0.0},
             [](const P& p) { return Law(p.x, p.v, kK * std::max(1.0 - 2.0 * p.t / kDuration, 0.0)); });
  ExpectSeen("stiffness_drift", "exponential", {-0.5, 2.0},
             [](const P& p) { return Law(p.x, p.v, kK * (1.0 - 0.5 * (1.0 - std::exp(-p.t / 2.0)))); });
  ExpectSeen("strain_stiffening", "exponential", {0.5, 0.1},
             [](const P& p) { return Law(p.x, p.v, kK * (1.0 + 0.5 * (std::exp(std::max(p.x, 0.0) / 0.1) - 1.0))); });
  ExpectSeen("dead_zone", "subtractive", {0.1},
             [](const P& p) { return Sign(p.base) * std::max(std::abs(p.base) - 0.1, 0.0); });
}

TEST(Effects, InertiaPushesByTheTrueAcceleration) {
  ExpectSeen(
      "inertia", "rigid", {0.2}, [](const Bench::Point& p) { return p.base - 0.2 * 2.7 * std::sin(3.0 * p.t); }, 1e-4,
      2);
}

TEST(Effects, ASecondOrderLagRespondsToAStepAsItsEquationSays) {
  const Motion step{[](double t) { return t < 0.1 - kDt / 2 ? 0.0 : 0.25; }, [](double) { return 0.0; }};
  const double force = Law(0.25, 0.0), tau = 0.05;
  // The step is a ramp of one sample, so that it lies half a sample earlier.
  const double since = 0.08 + 0.5 * kDt;
  EXPECT_NEAR(Bench("sensor_lag", "second_order", {tau}, step).At(0.18).seen,
              force * (1.0 - (1.0 + since / tau) * std::exp(-since / tau)), 1e-2 * force);
}

TEST(Effects, RelaxationDecaysInAHold) {
  const Motion hold{[](double t) { return t < 0.1 - kDt / 2 ? 0.0 : 0.25; }, [](double) { return 0.0; }};
  const double elastic = kK * std::pow(0.25, kP), since = 0.4 + 0.5 * kDt;
  EXPECT_NEAR(Bench("stress_relaxation", "linear", {3.0, 0.3}, hold).At(0.5).seen - elastic,
              3.0 * 0.25 * std::exp(-since / 0.3), 1e-5);
  EXPECT_NEAR(Bench("stress_relaxation", "elastic", {0.5, 0.3}, hold).At(0.5).seen - elastic,
              0.5 * elastic * std::exp(-since / 0.3), 1e-5);
  EXPECT_NEAR(Bench("stress_relaxation", "two_time_constants", {0.5, 0.1, 5.0}, hold).At(0.5).seen - elastic,
              0.25 * elastic * (std::exp(-since / 0.1) + std::exp(-since / 0.5)), 1e-5);
}

TEST(Effects, RelaxationStartsRelaxed) {
  const Motion hold{[](double) { return 0.25; }, [](double) { return 0.0; }};
  for (const char* variant : {"linear", "elastic"}) {
    Bench bench("stress_relaxation", variant, {3.0, 0.3}, hold);
    for (int i = 0; i < 10; ++i) EXPECT_EQ(bench.Next().seen, Law(0.25, 0.0)) << variant;
  }
}

TEST(Effects, PreslidingFrictionBuildsUpOverADistance) {
  const Motion slide{[](double t) { return -5.0 + 0.1 * t; }, [](double) { return 0.1; }};
  // z = x_s (1 - exp(-distance / x_s)), from rest at the first sample.
  EXPECT_NEAR(Bench("presliding_friction", "dahl", {0.5, 0.02}, slide).At(0.2).seen,
              0.5 * (1.0 - std::exp(-0.1 * 0.2 / 0.02)), 1e-12);
  // Slid on, the bristles carry the Stribeck level.
  EXPECT_NEAR(Bench("presliding_friction", "lugre", {0.5, 0.02, 0.6, 0.1, 0.005}, slide).At(9.0).seen,
              0.5 * (1.0 + 0.6 * std::exp(-1.0)), 1e-9);
  // In the first moment the stiff bristles also damp: z' = v.
  EXPECT_NEAR(Bench("presliding_friction", "lugre", {0.5, 0.02, 0.6, 0.1, 0.005}, slide).Next().seen,
              0.5 * 0.005 * 0.1 / 0.02, 1e-12);
}

TEST(Effects, PullOffHoldsBeyondTheSurfaceUntilTheNeckBreaks) {
  const Motion out{[](double t) { return 0.1 - t; }, [](double) { return -1.0; }};
  EXPECT_NEAR(Bench("adhesion", "pull_off", {0.3, 0.1}, out).At(0.15).seen, -0.3 * 0.5, 1e-9);
  EXPECT_EQ(Bench("adhesion", "pull_off", {0.3, 0.1}, out).At(0.25).seen, 0.0);
  const Motion never{[](double t) { return -0.01 - 0.01 * t; }, [](double) { return -0.01; }};
  EXPECT_EQ(Bench("adhesion", "pull_off", {0.3, 0.1}, never).At(0.5).seen, 0.0);
}

TEST(Effects, BacklashHoldsTheForceWhileTheGapIsCrossed) {
  const Motion turn{[](double t) { return t < 1.0 ? 0.3 * t : 0.6 - 0.3 * t; },
                    [](double t) { return t < 1.0 ? 0.3 : -0.3; }};
  EXPECT_NEAR(Bench("backlash", "play", {0.03}, turn).At(0.9).seen, Law(0.27 - 0.03, 0.3), 1e-9);
  // The drive turns at x = 0.3, where the needle stands at 0.27; until x = 0.24 it stays there.
  EXPECT_NEAR(Bench("backlash", "play", {0.03}, turn).At(1.1).seen, Law(0.27, 0.0), 1e-9);
  EXPECT_NEAR(Bench("backlash", "play", {0.03}, turn).At(1.5).seen, Law(0.15 + 0.03, -0.3), 1e-9);
}

TEST(Gate, LimitsEveryEffectToItsOpenSamples) {
  // A period of the sine, with contact and free motion in it; 0.5 s and 1.5 s are samples, the first of each side.
  constexpr int kSamples = 2'100;
  const auto is_open = [](const std::string& gate, int k, double x) {
    if (gate == "contact") return x >= 0.0;
    if (gate == "free") return x < 0.0;
    return gate == "from:0.5" ? k >= 500 : k < 1500;
  };
  for (const EffectSpec& spec : EffectRegistry(*FindPlantFamily("hunt_crossley"))) {
    std::vector<double> values;
    for (const EffectParameter& parameter : spec.parameters)
      values.push_back(parameter.lo > 0.0 ? std::sqrt(parameter.lo * parameter.hi) : 1.0);
    values[0] = 0.05;
    for (const std::string text : {"contact", "free", "from:0.5", "until:1.5"}) {
      const Gate gate = Gate::Parse(text);
      Bench gated(spec.name, spec.variant, values, kSine, gate), always(spec.name, spec.variant, values, kSine);
      for (int k = 0; k < kSamples; ++k) {
        const Bench::Point limited = gated.Next(), whole = always.Next();
        // Closed to the bit; open, the effect is the one whose memory ran on all the time.
        ASSERT_EQ(limited.seen, is_open(text, k, limited.x) ? whole.seen : whole.base)
            << spec.name << " " << text << " " << k;
      }
    }
  }
}

TEST(Gate, ReadsWhatItWritesAndNothingElse) {
  for (const char* text : {"always", "contact", "free", "from:8", "until:2.5"})
    EXPECT_EQ(Gate::Parse(text).Text(), text);
  for (const char* text : {"", "never", "from", "from:", "from:x", "from:-1", "until:nan", "contact:3", "from:3s"})
    EXPECT_THROW(static_cast<void>(Gate::Parse(text)), std::invalid_argument) << text;
}

}  // namespace
}  // namespace armcmc::plant_sim::effects_test
