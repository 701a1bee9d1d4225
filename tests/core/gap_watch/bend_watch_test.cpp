#include "plants/soft_actuator/bend_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "armcmc/estimator.hpp"
#include "armcmc/snapshot.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "plants/soft_actuator/gap_family.hpp"
#include "plants/soft_actuator/model.hpp"
#include "support/alloc_counter.hpp"
#include "support/packs.hpp"

namespace armcmc::bend_watch_test {
namespace {

using Law = std::function<double(double t, const BendMotion::State& state)>;  // rad/s^2 beside the base equation's
double Nothing(double, const BendMotion::State&) { return 0.0; }

/// The watch alone, on a joint that is integrated in steps of a tenth of a sample by another rule than the watch's.
class BendRig {
 public:
  explicit BendRig(double rate = 0.01)
      : settings_(BuiltinSettings("soft_actuator_excited")),
        predictor_(SoftActuator::kInfo, settings_.constants),
        watch_(settings_, rate, predictor_) {}

  DataPack Next() {
    DataPack pack = test::BlankPack(SoftActuator::kInfo.plant, ++seq, samples);
    pack.run_id = run_id;
    for (std::size_t n = 0; n < static_cast<std::size_t>(samples); ++n) {
      pack.t_last_s = t_;
      pack.u[n] = {0.0, 0.0, Pressure(t_) + pressure_noise * normal_(random_), 0.0};
      pack.y[n] = measure(t_, state_) + angle_noise * normal_(random_);
      Advance();
    }
    return pack;
  }
  void Give(const DataPack& pack) { watch_.Step(pack, {}); }
  /// @return time of the alarm, s; 0: none.
  double Run(double seconds) {
    for (double end = t_ + seconds; t_ < end;) Give(Next());
    return 1e-3 * samples * static_cast<double>(watch_.state().alarm_seq);
  }
  [[nodiscard]] BendWatch& watch() { return watch_; }
  [[nodiscard]] ActuatorConstants constants() const { return settings_.constants; }

  Law law = Nothing;
  Law measure = [](double, const BendMotion::State& state) { return state.angle; };
  double angle_noise = 2e-3, pressure_noise = 50.0;
  int samples = 100;
  std::int64_t seq = 0, run_id = 1;

 private:
  static double Pressure(double t) {
    return 101'325.0 + 45e3 + 20e3 * std::sin(2.0 * t) + 10e3 * std::sin(7.3 * t + 1.0);
  }
  void Advance() {
    constexpr int kSteps = 10;
    const double h = 1e-3 / kSteps;
    const auto acceleration = [&](double t, const BendMotion::State& s) {
      const ActuatorConstants c(settings_.constants);
      return c.q1 * (Pressure(t) - c.p_atm) - c.q2 * s.rate - c.q3 * s.angle + law(t, s);
    };
    for (int i = 0; i < kSteps; ++i) {  // the midpoint rule
      const double first = acceleration(t_, state_);
      const BendMotion::State half{state_.angle + 0.5 * h * state_.rate, state_.rate + 0.5 * h * first};
      const double second = acceleration(t_ + 0.5 * h, half);
      state_ = {state_.angle + h * half.rate, state_.rate + h * second};
      t_ += h;
    }
  }

  EstimatorSettings settings_;
  BendPredictor predictor_;
  BendWatch watch_;
  double t_ = 0.0;
  BendMotion::State state_{0.9, 0.0};
  std::mt19937_64 random_{7};
  std::normal_distribution<double> normal_;
};

TEST(BendWatch, IsSilentWhenNothingIsMissing) {
  BendRig rig;
  EXPECT_EQ(rig.Run(600.0), 0.0) << rig.watch().state().where.view();
  EXPECT_GE(rig.watch().state().num_blocks, 48);
  EXPECT_LT(rig.watch().state().log_evidence, rig.watch().state().log_threshold);
}

TEST(BendWatch, IsSilentOnDataWithoutNoise) {
  // What is left is the pressure between two samples, which the watch takes for linear.
  BendRig rig;
  rig.angle_noise = rig.pressure_noise = 0.0;
  EXPECT_EQ(rig.Run(120.0), 0.0) << rig.watch().state().where.view();
}

TEST(BendWatch, FindsWhatTheEquationLacks) {
  struct Missing {
    const char* name;
    Law law, measure;
    std::vector<std::string> where;  // any of
  };
  const Law angle = [](double, const BendMotion::State& s) { return s.angle; };
  for (const Missing& missing :
       {Missing{"friction",
                [](double, const auto& s) { return -20.0 * std::tanh(s.rate / 0.1); },
                angle,
                {"bend_direction"}},
        Missing{"load",
                [](double, const auto& s) { return -20.0 * std::sin(s.angle); },
                angle,
                {"bending", "bend_angle", "bend_slow_wander"}},
        Missing{"late sensor",
                Nothing,
                [](double, const auto& s) { return s.angle - 2e-3 * s.rate; },
                {"bend_speed", "bend_direction"}},
        Missing{"zero of the sensor",
                Nothing,
                [](double, const auto& s) { return s.angle + 2e-3; },
                {"bending", "bend_slow_wander"}},
        Missing{"wrong constants",
                [](double, const auto& s) { return 0.02 * (132.28 * s.rate + 3319.4 * s.angle); },
                angle,
                {"bend_angle", "bending", "bend_large_angle"}}}) {
    BendRig rig;
    rig.law = missing.law;
    rig.measure = missing.measure;
    const double alarm = rig.Run(60.0);
    EXPECT_GT(alarm, 0.0) << missing.name << ": log evidence " << rig.watch().state().log_evidence;
    const std::string where(rig.watch().state().where.view());
    EXPECT_TRUE(std::find(missing.where.begin(), missing.where.end(), where) != missing.where.end())
        << missing.name << ": " << where;
    EXPECT_EQ(rig.watch().CheckName(rig.watch().state().check), where);
  }
}

TEST(BendWatch, GoesOnAfterALossAndANewRun) {
  BendRig rig;
  for (int k = 1; k <= 1200; ++k) {
    const DataPack pack = rig.Next();
    if (k % 50 == 0) continue;  // lost
    if (k == 600) rig.run_id = 2;
    rig.Give(pack);
  }
  EXPECT_FALSE(rig.watch().state().suspected) << rig.watch().state().where.view();
  EXPECT_GE(rig.watch().state().num_blocks, 8);
  rig.law = [](double, const BendMotion::State& s) { return -20.0 * std::tanh(s.rate / 0.1); };
  for (int k = 1; k <= 600; ++k) {
    const DataPack pack = rig.Next();
    if (k % 50 != 0) rig.Give(pack);
  }
  EXPECT_TRUE(rig.watch().state().suspected);
}

TEST(BendWatch, JoinsPacksThatAreTooShort) {
  BendRig one, hundred;
  one.samples = 10;
  for (BendRig* rig : {&one, &hundred}) {
    rig->law = [](double, const BendMotion::State& s) { return -20.0 * std::tanh(s.rate / 0.1); };
    rig->Run(40.0);
  }
  EXPECT_EQ(one.watch().state().num_blocks, hundred.watch().state().num_blocks);
  EXPECT_NEAR(one.watch().state().log_evidence, hundred.watch().state().log_evidence, 1e-6);
}

TEST(BendWatch, KnowsAfterARestartWhatItKnew) {
  BendRig rig, other;
  rig.law = [](double, const BendMotion::State& s) { return -20.0 * std::tanh(s.rate / 0.1); };
  rig.Run(60.0);
  ASSERT_TRUE(rig.watch().state().suspected);
  std::vector<std::byte> bytes(1 << 16);
  SnapshotWriter writer(bytes);
  rig.watch().Save(&writer);
  SnapshotReader reader(std::span<const std::byte>(bytes).first(writer.size()));
  other.watch().Restore(&reader);
  EXPECT_TRUE(reader.finished());
  EXPECT_TRUE(other.watch().state().suspected);
  EXPECT_EQ(other.watch().state().where.view(), rig.watch().state().where.view());
  EXPECT_EQ(other.watch().state().log_evidence, rig.watch().state().log_evidence);
  other.watch().Reset();
  EXPECT_FALSE(other.watch().state().suspected);
  EXPECT_TRUE(other.watch().state().watched);
}

TEST(BendWatch, AllocatesNothing) {
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  const auto rig = std::make_unique<BendRig>();
  std::vector<DataPack> packs;
  packs.reserve(260);
  for (int k = 0; k < 260; ++k) packs.push_back(rig->Next());
  long allocations = 0;
  {
    const test::AllocCounter counter;
    for (const DataPack& pack : packs) rig->Give(pack);
    allocations = counter.count();
  }
  EXPECT_EQ(allocations, 0);
  EXPECT_EQ(rig->watch().state().num_blocks, 2);
}

TEST(GapCheckName, IsOfEitherEquation) {
  const Estimator actuator(BuiltinSettings("soft_actuator")), contact(BuiltinSettings("hunt_crossley"));
  EXPECT_EQ(actuator.gap_check_name(0), "any_valve");
  EXPECT_EQ(actuator.gap_check_name(BendChecks().first + kBendDirection), "bend_direction");
  EXPECT_EQ(actuator.gap_check_name(BendChecks().first - 1), "wander_after_two_packs");
  EXPECT_EQ(actuator.gap_check_name(BendChecks().first + BendChecks().size()), "");
  EXPECT_EQ(contact.gap_check_name(BendChecks().first + BendChecks().size() - 1), "");
  EXPECT_EQ(contact.gap_check_name(-1), "");
}

}  // namespace
}  // namespace armcmc::bend_watch_test
