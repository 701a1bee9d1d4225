#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "armcmc/plant_sim/effects/gate.hpp"
#include "armcmc/plant_sim/law_error.hpp"
#include "armcmc/plant_sim/plant.hpp"
#include "soft_actuator/actuator_effect.hpp"
#include "soft_actuator/valve_controller.hpp"

namespace armcmc::plant_sim {

/// Fluid soft bending actuator (Wang et al. 2019, with the paper's two-mode valve equation):
///
///   alpha'' = q1 (p - p_atm) - q2 alpha' - q3 alpha                       rad, Pa
///   u_c sign(p_s - p) sqrt|p_s - p|     = p' (theta1_c + theta2_c p)      while the fill valve is open
///   u_d sign(p - p_atm) sqrt|p - p_atm| = p' (theta1_d + theta2_d p)      otherwise
///
/// The left side is the valve flow. Reported parameters of a mode: g = theta1 + theta2 p_atm and theta2, so that
/// flow = p' (g + theta2 (p - p_atm)). With an `error` of the law p' is this times a LawError of pressure and opening.
class SoftActuatorPlant final : public Plant {
 public:
  explicit SoftActuatorPlant(const PlantSetup& setup);

  void Hide(const std::vector<HiddenEffect>& effects, const EffectTiming& timing) override;
  void Advance(PlantSample* sample) noexcept override;
  [[nodiscard]] Theta Truth(int mode, double t_s) const noexcept override;
  [[nodiscard]] double Predict(const Theta& theta, const PlantSample& sample) const noexcept override;
  [[nodiscard]] double Target(const PlantSample& sample) const noexcept override;

  static constexpr int kFill = 0, kVent = 1;
  enum Input { kUc = 0, kUd = 1, kPressure = 2, kPressureRate = 3 };

 private:
  using State = Eigen::Vector3d;  ///< alpha, alpha', p - p_atm.

  [[nodiscard]] double Flow(const ValveOpening& valve, double gauge_pressure) const noexcept;
  /// Fill while u_c > 0; with both valves shut the vent side stays selected, as in the paper.
  [[nodiscard]] static int Mode(const ValveOpening& valve) noexcept { return valve.fill > 0.0 ? kFill : kVent; }
  [[nodiscard]] double PressureRate(const ValveOpening& valve, double gauge_pressure, double t_s) const noexcept;
  struct Hidden {
    Gate gate;
    std::unique_ptr<ActuatorEffect> effect;
  };
  [[nodiscard]] static bool Acts(const Hidden& hidden, double t_s) noexcept;
  /// What hidden effects add to the derivative.
  [[nodiscard]] State HiddenDerivative(double t_s, const State& state, const State& base) const noexcept;
  /// What the valves do when commanded so; effects with memory go one sample on.
  [[nodiscard]] ValveOpening StepHidden(double t_s, const ValveOpening& command) noexcept;

  Schedule schedule_;
  double p_atm_, p_supply_, q1_, q2_, q3_, dt_;
  int substeps_;
  LawError error_;
  std::unique_ptr<ValveController> controller_;
  State state_ = State::Zero();
  std::vector<Hidden> hidden_;
  ValveOpening valve_;  ///< As the valves stand, not as they are commanded.
  double last_angle_ = 0.0, last_pdot_ = 0.0;
  long long k_ = -1;  ///< Index of the last sample.
};

[[nodiscard]] const PlantFamily& SoftActuatorFamily();

}  // namespace armcmc::plant_sim
