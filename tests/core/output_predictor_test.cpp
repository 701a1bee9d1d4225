#include "armcmc/output_predictor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "armcmc/models/compiled_plant.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "plants/soft_actuator/bend_predictor.hpp"
#include "plants/soft_actuator/model.hpp"
#include "support/packs.hpp"

namespace armcmc::output_predictor_test {
namespace {

using Outputs = std::array<double, kMaxPackSamples>;
constexpr int kSamples = 100;
constexpr double kDt = 1e-3;

ActuatorConstants Excited() {
  ActuatorConstants constants;
  constants.q1 = 0.0704;
  return constants;
}

/// Truth of the excited actuator: gain form of the two modes.
ShownEstimates Truth() {
  ShownEstimates shown;
  const double p_atm = ActuatorConstants{}.p_atm;
  shown.known = {true, true};
  shown.theta[0] = {-2.14e-4 + 6.12e-9 * p_atm, 6.12e-9};
  shown.theta[1] = {-9.76e-5 - 1.9e-9 * p_atm, -1.9e-9};
  return shown;
}

/// The actuator by fourth-order Runge-Kutta with 50 steps a sample; valves hold their opening over a sample.
class ReferenceActuator {
 public:
  DataPack NextPack(std::int64_t seq) {
    DataPack pack = test::BlankPack(SoftActuator::kInfo.plant, seq, kSamples, kDt);
    for (std::size_t n = 0; n < kSamples; ++n) {
      const double t = kDt * static_cast<double>(sample_++);
      // Fill for 0.2 s, hold, vent; a ripple on top so that the opening is never constant.
      const double u_c = t < 0.2 ? 0.05 + 0.02 * std::sin(40.0 * t) : 0.0;
      const double u_d = t > 0.25 ? 0.03 + 0.01 * std::sin(50.0 * t) : 0.0;
      pack.u[n] = {u_c, u_d, state_[0], Slope(u_c, u_d, state_)[0]};
      pack.y[n] = state_[1];
      for (int k = 0; k < 50; ++k) Step(u_c, u_d, kDt / 50);
    }
    return pack;
  }

 private:
  using State = std::array<double, 3>;  // p, alpha, its rate

  [[nodiscard]] State Slope(double u_c, double u_d, const State& s) const {
    double p_rate = 0.0;
    const double over = s[0] - constants_.p_atm;
    if (u_c != 0.0)
      p_rate = u_c * std::sqrt(constants_.p_supply - s[0]) / (truth_.theta[0][0] + truth_.theta[0][1] * over);
    else if (u_d != 0.0)
      p_rate = u_d * std::sqrt(over) / (truth_.theta[1][0] + truth_.theta[1][1] * over);
    return {p_rate, s[2], constants_.q1 * over - constants_.q2 * s[2] - constants_.q3 * s[1]};
  }
  void Step(double u_c, double u_d, double h) {
    const auto add = [](const State& a, const State& b, double k) {
      return State{a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]};
    };
    const State k1 = Slope(u_c, u_d, state_);
    const State k2 = Slope(u_c, u_d, add(state_, k1, h / 2));
    const State k3 = Slope(u_c, u_d, add(state_, k2, h / 2));
    const State k4 = Slope(u_c, u_d, add(state_, k3, h));
    for (std::size_t i = 0; i < 3; ++i) state_[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  }

  ActuatorConstants constants_ = Excited();
  ShownEstimates truth_ = Truth();
  State state_{ActuatorConstants{}.p_atm, 0.0, 0.0};
  int sample_ = 0;
};

TEST(OutputPredictor, ContactForceIsUnknownBeforeAnEstimateAndZeroInFreeMotion) {
  const std::unique_ptr<OutputPredictor> predictor =
      HuntCrossley::kInfo.compiled->make_predictor(HuntCrossley::kInfo, {}, nullptr);
  DataPack pack;
  pack.num_samples = 2;
  pack.u[0] = {-0.1, 0.0};
  pack.u[1] = {0.1, 0.0};
  Outputs output, free_run;
  predictor->Predict(pack, {}, &output, &free_run);
  EXPECT_EQ(output[0], 0.0);
  EXPECT_TRUE(std::isnan(output[1]));
}

TEST(OutputPredictor, AngleFollowsAFineReference) {
  BendPredictor predictor(SoftActuator::kInfo, Excited());
  ReferenceActuator plant;
  double largest = 0.0;
  for (std::int64_t seq = 1; seq <= 4; ++seq) {
    const DataPack pack = plant.NextPack(seq);
    Outputs output, free_run;
    predictor.Predict(pack, Truth(), &output, &free_run);
    for (std::size_t n = 0; n < kSamples; ++n) {
      // Heun's local error in p is below 1e-3 Pa a sample here, and q1 / q3 turns a pascal into 2e-5 rad.
      EXPECT_NEAR(output[n], pack.y[n], 2e-6) << seq << " " << n;
      EXPECT_NEAR(free_run[n], pack.y[n], 2e-5) << seq << " " << n;
      largest = std::fmax(largest, pack.y[n]);
    }
  }
  EXPECT_GT(largest, 0.1) << "the reference must move";
}

TEST(OutputPredictor, LastOutputEqualsThePredictionWithTheSameParameters) {
  BendPredictor predictor(SoftActuator::kInfo, Excited());
  ReferenceActuator plant;
  Outputs output, free_run;
  for (std::int64_t seq = 1; seq <= 2; ++seq) {
    const DataPack pack = plant.NextPack(seq);
    predictor.Predict(pack, Truth(), &output, &free_run);
    const ShownEstimates truth = Truth();
    EXPECT_EQ(predictor.LastOutput(pack, truth, 0, truth.theta[0].data()), output[kSamples - 1]);
    std::array<double, kMaxParams> stiffer = truth.theta[0];
    stiffer[0] *= 1.5;  // more valve opening for the same rate: the pressure rises less
    EXPECT_LT(predictor.LastOutput(pack, truth, 0, stiffer.data()), output[kSamples - 1]);
  }
}

TEST(OutputPredictor, InputsBeforeTheFirstEstimateAreCaughtUp) {
  BendPredictor informed(SoftActuator::kInfo, Excited()), late(SoftActuator::kInfo, Excited());
  ReferenceActuator plant;
  Outputs output, informed_run, late_run;
  for (std::int64_t seq = 1; seq <= 4; ++seq) {
    const DataPack pack = plant.NextPack(seq);
    informed.Predict(pack, Truth(), &output, &informed_run);
    late.Predict(pack, seq <= 2 ? ShownEstimates{} : Truth(), &output, &late_run);
  }
  for (std::size_t n = 1; n < kSamples; ++n) EXPECT_EQ(late_run[n], informed_run[n]);
}

TEST(OutputPredictor, AngleStaysFiniteWhenNothingIsEverKnown) {
  BendPredictor predictor(SoftActuator::kInfo, Excited());
  ReferenceActuator plant;
  Outputs output, free_run;
  DataPack pack = plant.NextPack(1);
  pack.num_samples = kMaxPackSamples;
  for (std::int64_t seq = 1; seq <= 3 * BendPredictor::kBacklogPacks; ++seq) {
    pack.seq = seq;
    for (std::size_t n = kSamples; n < kMaxPackSamples; ++n) pack.u[n] = pack.u[n - kSamples];
    predictor.Predict(pack, {}, &output, &free_run);
    for (std::size_t n = 0; n < kMaxPackSamples; ++n)
      ASSERT_TRUE(std::isfinite(output[n]) && std::isfinite(free_run[n]));
  }
}

TEST(OutputPredictor, AGapAndAnotherRunRestartFromTheMeasurements) {
  BendPredictor predictor(SoftActuator::kInfo, Excited());
  ReferenceActuator plant;
  Outputs output, free_run;
  predictor.Predict(plant.NextPack(1), Truth(), &output, &free_run);
  (void)plant.NextPack(2);
  const DataPack after_gap = plant.NextPack(3);
  predictor.Predict(after_gap, Truth(), &output, &free_run);
  EXPECT_EQ(output[0], after_gap.y[0]);
  EXPECT_EQ(free_run[0], after_gap.y[0]);
  DataPack other = plant.NextPack(4);
  other.run_id = after_gap.run_id + 1;
  other.y[0] = 0.3;
  predictor.Predict(other, Truth(), &output, &free_run);
  EXPECT_EQ(output[0], 0.3);
  EXPECT_EQ(free_run[0], 0.3);
}

}  // namespace
}  // namespace armcmc::output_predictor_test
