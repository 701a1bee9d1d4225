#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "armcmc/plant_sim/effects/effect_chain.hpp"
#include "armcmc/plant_sim/effects/gap_meter.hpp"
#include "armcmc/plant_sim/solver.hpp"
#include "soft_actuator/effects.hpp"
#include "soft_actuator/plant.hpp"

namespace armcmc::plant_sim {
namespace {

/// The larger of two gap ratios, each of one equation: the valve flow's, refitted per valve by weighted least squares
/// of u sqrt|dp| = p' (g + theta2 (p - p_atm)) in units of the p' noise, and the bend equation's, free-running on the
/// pressure that is seen with the known q1, q2, q3, in units of the angle's noise.
class ActuatorGapMeter final : public GapMeter {
 public:
  explicit ActuatorGapMeter(const Scenario& scenario) : scenario_(scenario) {
    rate_sd_ = NoiseSd(scenario.noise[SoftActuatorPlant::kPressureRate]);
    angle_sd_ = NoiseSd(scenario.noise.back());
    if (!(rate_sd_ > 0.0) || !(angle_sd_ > 0.0))
      throw std::invalid_argument("the scenario has no noise on pdot or alpha: a gap ratio is undefined");
    scales_.fill(1.0);
    scales_[static_cast<std::size_t>(EffectScale::kDuration)] = scenario.duration_s;
  }

  [[nodiscard]] double GapRatio(const std::vector<HiddenEffect>& effects) const override {
    const EffectTiming timing{scenario_.sample_interval_s, scenario_.duration_s};
    const auto plant = scenario_.MakePlant();
    plant->Hide(effects, timing);
    EffectChain chain(effects, timing, plant.get());
    const long long last = std::min(scenario_.last_sample(scenario_.num_packs()), kMaxGapSamples);
    const double p_atm = scenario_.options.Number("p_atm");
    std::array<Valve, 2> valves;
    Eigen::Vector2d bend = Eigen::Vector2d::Zero();
    double last_gauge = 0.0, bend_sq = 0.0;
    PlantSample truth;
    for (long long i = 0; i <= last; ++i) {
      plant->Advance(&truth);
      const PlantSample& seen = chain.Apply(truth);
      if (!std::isfinite(seen.output) || !std::isfinite(seen.inputs[SoftActuatorPlant::kPressure]))
        return std::numeric_limits<double>::infinity();
      const double gauge = seen.inputs[SoftActuatorPlant::kPressure] - p_atm;
      if (i > 0) bend = Bend(bend, last_gauge, gauge, timing.dt_s);
      last_gauge = gauge;
      bend_sq += (seen.output - bend[0]) * (seen.output - bend[0]);
      const Theta theta = plant->Truth(truth.mode, truth.t_s);
      const double weight = 1.0 / (rate_sd_ * (theta[0] + theta[1] * (truth.inputs[2] - p_atm)));
      valves[static_cast<std::size_t>(truth.mode)].Add(weight * seen.inputs[3] * Eigen::Vector2d(1.0, gauge * 1e-5),
                                                       weight * (plant->Target(seen) - plant->Predict(theta, seen)));
    }
    const auto n = static_cast<double>(last + 1);
    const double flow_sq = valves[0].Remainder() + valves[1].Remainder();
    return std::max(std::sqrt(std::max(flow_sq, 0.0) / n), std::sqrt(bend_sq / n) / angle_sd_);
  }

  [[nodiscard]] const EffectScales& scales() const override { return scales_; }

 private:
  struct Valve {
    Eigen::Matrix2d h = Eigen::Matrix2d::Identity() * 1e-12;
    Eigen::Vector2d g = Eigen::Vector2d::Zero();
    double sum_sq = 0.0;
    void Add(const Eigen::Vector2d& slope, double residual) {
      h += slope * slope.transpose();
      g += slope * residual;
      sum_sq += residual * residual;
    }
    [[nodiscard]] double Remainder() const { return sum_sq - g.dot(h.ldlt().solve(g)); }
  };

  [[nodiscard]] Eigen::Vector2d Bend(const Eigen::Vector2d& from, double gauge, double next, double dt) const {
    const double q1 = scenario_.options.Number("q1"), q2 = scenario_.options.Number("q2");
    const double q3 = scenario_.options.Number("q3");
    constexpr int kSteps = 4;
    const double h = dt / kSteps;
    Eigen::Vector2d state = from;
    const auto derivative = [&](double at, const Eigen::Vector2d& y) -> Eigen::Vector2d {
      return {y[1], q1 * (gauge + at / dt * (next - gauge)) - q2 * y[1] - q3 * y[0]};
    };
    for (int i = 0; i < kSteps; ++i) state = BogackiShampineStep(derivative, i * h, state, h);
    return state;
  }

  Scenario scenario_;
  double rate_sd_ = 0.0, angle_sd_ = 0.0;
  EffectScales scales_{};
};

}  // namespace

std::unique_ptr<GapMeter> MakeActuatorGapMeter(const Scenario& scenario) {
  return std::make_unique<ActuatorGapMeter>(scenario);
}

}  // namespace armcmc::plant_sim
