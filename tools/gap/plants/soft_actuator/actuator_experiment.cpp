#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "armcmc/gap/experiment.hpp"
#include "armcmc/gap/search.hpp"
#include "gap/plants/soft_actuator/actuator_equation.hpp"

namespace armcmc::gap {
namespace {

constexpr double kHighest = 80e3;       // Pa above p_atm, of the steps
constexpr double kWidest = 3.0;         // rad
constexpr double kModestGain = 0.0704;  // rad/s^2 per Pa: 60 kPa bend the actuator by 1.3 rad

/// A motion of the plant's library.
struct Program {
  const char* controller;
  const char* words;
  std::vector<double> levels;  ///< Pa above p_atm; empty: the controller knows none.
  double dwell_s;
  double opening_per_pa = 1e-5;  ///< Of the valves, for what the pressure is off.
};

const Program kSwings = {"pressure_steps",
                         "step the pressure between levels of 15 to 80 kPa every half second, both valves in turn",
                         {60e3, 25e3, 80e3, 45e3, 70e3, 15e3, 50e3, 30e3},
                         0.5};

/// Effects that a motion tells apart.
struct Rule {
  std::vector<std::string> effects;
  Program program;
};

const std::vector<Rule>& Rules() {
  static const std::vector<Rule> rules = {
      {{"pressure_bias", "angle_bias"},
       {"pressure_steps",
        "vent with a wide open valve to a few tens of pascals above the atmosphere, and fill again: near p_atm the "
        "vent flow is sensitive to every pascal of a pressure bias, and not at all to an angle bias",
        {4e3, 30.0, 15e3, 40.0, 30e3, 50.0},
        0.35,
        2e-4}},
      {{"leak", "pressure_bias"},
       {"closed_valve_hold", "hold with both valves shut, after steps to several pressures", {80e3, 40e3, 60e3}, 0.5}},
      {{"leak", "supply_droop"},
       {"closed_valve_hold", "hold with both valves shut, after steps to several pressures", {80e3, 40e3, 60e3}, 0.5}},
      {{"valve_dead_band", "leak"},
       {"u_triangle", "open and close both valves in slow triangles of two heights", {}, 2.0}},
      {{"valve_dead_band", "valve_lag"},
       {"u_triangle", "open and close both valves in slow triangles of two heights", {}, 2.0}},
      {{"valve_dead_band", "supply_droop"},
       {"u_triangle", "open and close both valves in slow triangles of two heights", {}, 2.0}},
      {{"joint_friction", "hysteresis"},
       {"fast_and_slow_fills",
        "fill fast and slowly over the same range: hysteresis does not depend on the speed",
        {60e3, 20e3, 80e3, 40e3},
        1.0}},
      {{"joint_friction", "sensor_delay"},
       {"fast_and_slow_fills",
        "fill fast and slowly over the same range: a delay shows only at speed",
        {60e3, 20e3, 80e3, 40e3},
        1.0}},
      {{"cubic_stiffness", "gravity_load"},
       {"pressure_steps",
        "bend as far as it goes, and to many angles in between",
        {95e3, 10e3, 75e3, 40e3, 90e3, 20e3},
        0.5}}};
  return rules;
}

const Program& Choose(const std::vector<CandidatePtr>& candidates) {
  const auto holds = [&](const std::string& effect) {
    return std::any_of(candidates.begin(), candidates.end(), [&](const CandidatePtr& candidate) {
      const auto names = candidate->names();
      return std::find(names.begin(), names.end(), effect) != names.end();
    });
  };
  for (const Rule& rule : Rules())
    if (std::all_of(rule.effects.begin(), rule.effects.end(), holds)) return rule.program;
  return kSwings;
}

}  // namespace

Experiment ActuatorExperiment(const Signals& signals, const ActuatorConstants& constants,
                              const std::vector<CandidatePtr>& candidates) {
  const Program& program = Choose(candidates);
  Experiment experiment;
  experiment.program = program.controller;
  experiment.sample_interval_s = signals.dt;
  experiment.words = std::string(candidates.empty() ? "To make the flow law identifiable: " : "To separate them: ") +
                     program.words + ".";
  // A gain that bends the actuator around itself at these pressures is not one of them.
  const bool absurd = constants.q1 * kHighest / constants.q3 > kWidest;
  std::ostringstream out;
  out.precision(10);
  out << "# " << experiment.words
      << "\nschema = 1\nplant = \"soft_actuator\"\nduration_s = 20.0\nsample_interval_s = " << signals.dt
      << "\npack_period_s = " << 100.0 * signals.dt
      << "\n\n[parameters]   # of the fill valve (u_c) and the vent valve (u_d); typical ones\n"
         "theta1_c = -2.14e-4\ntheta2_c = 6.12e-9\ntheta1_d = -9.76e-5\ntheta2_d = -1.9e-9\n\n[constants]\np_atm = "
      << constants.p_atm << "      # Pa\np_supply = " << constants.p_supply
      << "   # Pa\nq1 = " << (absurd ? kModestGain : constants.q1)
      << (absurd ? "   # rad/s^2 per Pa: the model's own would bend it by more than 3 rad" : "")
      << "\nq2 = " << constants.q2 << "\nq3 = " << constants.q3 << "\nmax_step_s = " << 0.1 * signals.dt
      << "\n\n[motion]\ncontroller = \"" << program.controller << "\"\ndwell_s = " << program.dwell_s
      << "\nopening_per_pa = " << program.opening_per_pa << "   # 1/Pa\nmax_opening = 0.1\n";
  if (!program.levels.empty()) {
    out << "pressure_levels = [";
    for (std::size_t i = 0; i < program.levels.size(); ++i) out << (i > 0 ? ", " : "") << program.levels[i];
    out << "]   # Pa above p_atm\n";
  }
  out << "\n[noise.p]\nkind = \"gaussian\"\nstd = 50.0    # Pa\n\n[noise.pdot]\nkind = \"gaussian\"\nstd = 500.0   # "
         "Pa/s\n\n[noise.alpha]\nkind = \"gaussian\"\nstd = 0.002   # rad\n";
  experiment.scenario_text = out.str();
  return experiment;
}

}  // namespace armcmc::gap
