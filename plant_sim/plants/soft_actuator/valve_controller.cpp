#include "soft_actuator/valve_controller.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace armcmc::plant_sim {
namespace {

// Keeps a sample that stands on a step on its later side, whatever the rounding of k T.
constexpr double kOnTime = 1e-9;

}  // namespace

AngleReferenceController::AngleReferenceController(const Options& options, double sample_interval_s)
    : references_(options.List("reference_angles")),
      switch_times_(options.List("switch_times_s")),
      gain_(options.Number("valve_gain")),
      dt_(sample_interval_s) {
  if (references_.size() != switch_times_.size() + 1)
    throw std::invalid_argument("motion.reference_angles must have one entry more than motion.switch_times_s");
  if (!std::is_sorted(switch_times_.begin(), switch_times_.end()))
    throw std::invalid_argument("motion.switch_times_s must not decrease");
  const auto pid = [&options](const char* key) {
    const std::vector<double>& gains = options.List(key);
    if (gains.size() != 4) throw std::invalid_argument(std::string("motion.") + key + " must be [P, I, D, N]");
    return Pid{gains[0], gains[1], gains[2], gains[3]};
  };
  fill_ = pid("fill_pid");
  vent_ = pid("vent_pid");
}

double AngleReferenceController::Pid::Step(double error, double dt) noexcept {
  const double command = p * error + integral + n * (d * error - filter);
  integral += i * error * dt;
  // The filter's third-order step with the error held: exp(-n dt) up to its cubic term.
  const double z = n * dt;
  const double decay = 1.0 - z * (1.0 - z / 2.0 * (1.0 - z / 3.0));
  filter = d * error + (filter - d * error) * decay;
  return command;
}

ValveOpening AngleReferenceController::Step(const ActuatorView& view) noexcept {
  std::size_t i = 0;
  while (i < switch_times_.size() && view.t_s >= switch_times_[i]) ++i;
  const double reference = references_[i];
  const double error = reference - view.last_pdot;
  const double fill = std::clamp(gain_ * fill_.Step(error, dt_), 0.0, 1.0);
  const double vent = std::clamp(gain_ * vent_.Step(error, dt_), 0.0, 1.0);
  return reference > view.last_angle ? ValveOpening{fill, 0.0} : ValveOpening{0.0, vent};
}

PressureStepController::PressureStepController(const Options& options, double p_atm)
    : levels_(options.List("pressure_levels")),
      dwell_s_(options.Number("dwell_s")),
      opening_per_pa_(options.Number("opening_per_pa")),
      max_opening_(options.Number("max_opening")) {
  if (levels_.empty()) throw std::invalid_argument("motion.pressure_levels must not be empty");
  for (double& level : levels_) level += p_atm;
}

ValveOpening PressureStepController::Step(const ActuatorView& view) noexcept {
  const auto step = static_cast<std::size_t>(view.t_s / dwell_s_ + kOnTime);
  const double distance = levels_[step % levels_.size()] - view.pressure;
  const double opening = std::min(max_opening_, opening_per_pa_ * std::abs(distance));
  return distance > 0.0 ? ValveOpening{opening, 0.0} : ValveOpening{0.0, opening};
}

ClosedValveHoldController::ClosedValveHoldController(const Options& options, double p_atm)
    : steps_(options, p_atm), dwell_s_(options.Number("dwell_s")), hold_s_(options.Number("hold_s")) {}

ValveOpening ClosedValveHoldController::Step(const ActuatorView& view) noexcept {
  const double cycle = dwell_s_ + hold_s_;
  const double cycles = std::floor(view.t_s / cycle + kOnTime), passed = view.t_s - cycles * cycle;
  if (passed > (1.0 - kOnTime) * dwell_s_) return {};
  // The steps know nothing of the holds: their time stands still meanwhile.
  ActuatorView at = view;
  at.t_s = cycles * dwell_s_ + std::max(passed, 0.0);
  return steps_.Step(at);
}

TriangleController::TriangleController(const Options& options)
    : period_s_(options.Number("dwell_s")),
      max_opening_(options.Number("max_opening")),
      fill_share_(options.Number("fill_share")) {}

ValveOpening TriangleController::Step(const ActuatorView& view) noexcept {
  constexpr double kLow = 0.4;
  const double periods = std::floor(view.t_s / period_s_), share = view.t_s / period_s_ - periods;
  const double height = max_opening_ * (std::fmod(periods, 2.0) == 0.0 ? 1.0 : kLow);
  const double opening = height * (1.0 - std::abs(4.0 * std::fmod(share, 0.5) - 1.0));
  return share < 0.5 ? ValveOpening{fill_share_ * opening, 0.0} : ValveOpening{0.0, opening};
}

FastAndSlowFillsController::FastAndSlowFillsController(const Options& options, double p_atm)
    : steps_(options, p_atm), dwell_s_(options.Number("dwell_s")) {}

ValveOpening FastAndSlowFillsController::Step(const ActuatorView& view) noexcept {
  constexpr double kSlow = 0.125;
  const ValveOpening opening = steps_.Step(view);
  const double pair = std::floor(0.5 * (view.t_s / dwell_s_ + kOnTime));
  const double share = std::fmod(pair, 2.0) == 0.0 ? 1.0 : kSlow;
  return {share * opening.fill, share * opening.vent};
}

std::vector<OptionSpec> ValveControllerOptions() {
  return {OptionSpec::Choice(
              "motion", "controller",
              {"angle_reference", "pressure_steps", "closed_valve_hold", "u_triangle", "fast_and_slow_fills"}),
          OptionSpec::List("motion", "reference_angles", {0.8, 0.195, 1.4}, -10.0, 10.0),
          OptionSpec::List("motion", "switch_times_s", {5.0, 14.0}, 0.0, 1e6),
          OptionSpec::List("motion", "fill_pid", {1.0, 0.15, 0.03, 100.0}, 0.0, 1e6),
          OptionSpec::List("motion", "vent_pid", {100.0, 30.0, 10.0, 100.0}, 0.0, 1e6),
          OptionSpec::Number("motion", "valve_gain", 1e-7, 0.0, 1.0),
          OptionSpec::List("motion", "pressure_levels", {60e3, 20e3}, 0.0, 1e6),
          OptionSpec::Number("motion", "dwell_s", 0.5, 1e-3, 1e3),
          OptionSpec::Number("motion", "opening_per_pa", 1e-5, 0.0, 1.0),
          OptionSpec::Number("motion", "max_opening", 0.1, 0.0, 1.0),
          OptionSpec::Number("motion", "hold_s", 1.5, 1e-3, 1e3),
          OptionSpec::Number("motion", "fill_share", 0.3, 0.0, 1.0)};
}

std::unique_ptr<ValveController> MakeValveController(const Options& options, double p_atm, double sample_interval_s) {
  const std::string& controller = options.Choice("controller");
  if (controller == "pressure_steps") return std::make_unique<PressureStepController>(options, p_atm);
  if (controller == "closed_valve_hold") return std::make_unique<ClosedValveHoldController>(options, p_atm);
  if (controller == "u_triangle") return std::make_unique<TriangleController>(options);
  if (controller == "fast_and_slow_fills") return std::make_unique<FastAndSlowFillsController>(options, p_atm);
  return std::make_unique<AngleReferenceController>(options, sample_interval_s);
}

}  // namespace armcmc::plant_sim
