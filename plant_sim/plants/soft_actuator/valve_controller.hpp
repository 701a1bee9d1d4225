#pragma once

#include <array>
#include <memory>
#include <vector>

#include "armcmc/plant_sim/options.hpp"

namespace armcmc::plant_sim {

/// What the controller of the two valves sees at a sample.
struct ActuatorView {
  double t_s;         ///< Plant time, s.
  double pressure;    ///< Pa, absolute.
  double last_angle;  ///< rad, one sample ago.
  double last_pdot;   ///< Pa/s, one sample ago.
};

/// Openings of the valves, each in [0, 1]; at most one is open.
struct ValveOpening {
  double fill = 0.0;  ///< u_c, from the supply.
  double vent = 0.0;  ///< u_d, to the atmosphere.
};

/// Decides the valve openings once a sample; they are held until the next.
class ValveController {
 public:
  virtual ~ValveController() = default;
  /// @rt No heap, no lock, no throw.
  [[nodiscard]] virtual ValveOpening Step(const ActuatorView& view) noexcept = 0;
};

/// The paper's controller. Two PID laws run all the time on e = reference - p' (the reference is an angle, but
/// the loop behind the paper's traces subtracts the pressure rate); the first drives the fill valve while the
/// reference is above the angle, the second the vent valve otherwise:
///
///   u = gain (P e + I int e + N (D e - z)),   z' = N (D e - z),   clipped to [0, 1]
///
/// e is the value of the last sample's p', held over T; the states take one third-order step per T.
class AngleReferenceController final : public ValveController {
 public:
  AngleReferenceController(const Options& options, double sample_interval_s);
  [[nodiscard]] ValveOpening Step(const ActuatorView& view) noexcept override;

 private:
  struct Pid {
    double p, i, d, n;
    double integral = 0.0, filter = 0.0;
    [[nodiscard]] double Step(double error, double dt) noexcept;
  };
  std::vector<double> references_, switch_times_;
  Pid fill_, vent_;
  double gain_, dt_;
};

/// Excitation for identification: the pressure steps from level to level, every `dwell_s`; the valve on the
/// right side of the level opens in proportion to the distance, at most `max_opening`.
class PressureStepController final : public ValveController {
 public:
  PressureStepController(const Options& options, double p_atm);
  [[nodiscard]] ValveOpening Step(const ActuatorView& view) noexcept override;

 private:
  std::vector<double> levels_;  ///< Pa, absolute.
  double dwell_s_, opening_per_pa_, max_opening_;
};

/// The same steps, each followed by `hold_s` with both valves shut: whatever the pressure then does, no valve did it.
class ClosedValveHoldController final : public ValveController {
 public:
  ClosedValveHoldController(const Options& options, double p_atm);
  [[nodiscard]] ValveOpening Step(const ActuatorView& view) noexcept override;

 private:
  PressureStepController steps_;
  double dwell_s_, hold_s_;
};

/// Openings that follow a triangle around zero, without feedback: fill while it is positive, vent while it is negative.
/// Its period is `dwell_s`, its height `max_opening` and, every second period, 0.4 of that. The fill valve opens
/// `fill_share` as far as the vent valve, which has the smaller pressure behind it.
class TriangleController final : public ValveController {
 public:
  explicit TriangleController(const Options& options);
  [[nodiscard]] ValveOpening Step(const ActuatorView& view) noexcept override;

 private:
  double period_s_, max_opening_, fill_share_;
};

/// The same steps, every second pair of them with valves that open an eighth as far.
class FastAndSlowFillsController final : public ValveController {
 public:
  FastAndSlowFillsController(const Options& options, double p_atm);
  [[nodiscard]] ValveOpening Step(const ActuatorView& view) noexcept override;

 private:
  PressureStepController steps_;
  double dwell_s_;
};

[[nodiscard]] std::vector<OptionSpec> ValveControllerOptions();
/// @throws std::invalid_argument when the options contradict each other.
[[nodiscard]] std::unique_ptr<ValveController> MakeValveController(const Options& options, double p_atm,
                                                                   double sample_interval_s);

}  // namespace armcmc::plant_sim
