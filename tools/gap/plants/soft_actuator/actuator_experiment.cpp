#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "armcmc/gap/experiment.hpp"
#include "armcmc/gap/search.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "gap/plants/soft_actuator/actuator_equation.hpp"

namespace armcmc::embedded {
std::string_view ValveExperiments() noexcept;
}  // namespace armcmc::embedded

namespace armcmc::gap {
namespace {

constexpr double kHighest = 80e3;       // Pa above p_atm, of the steps
constexpr double kWidest = 3.0;         // rad
constexpr double kModestGain = 0.0704;  // rad/s^2 per Pa: 60 kPa bend the actuator by 1.3 rad

/// A motion of the simulator's library.
struct Program {
  std::vector<std::string> tells_apart;  ///< Effects.
  std::string controller;
  std::string words;
  std::vector<double> levels;  ///< Pa above p_atm; empty: the controller knows none.
  double dwell_s;
  double opening_per_pa;  ///< Of the valves, for what the pressure is off.
};

std::vector<Program> ReadPrograms() {
  constexpr std::size_t kMostLevels = 100;
  support::StrictTable root = support::StrictTable::FromText(embedded::ValveExperiments(), "valves.toml");
  root.RequireSchema();
  std::vector<Program> programs;
  for (support::StrictTable& table : root.Tables("experiment"))
    programs.push_back({table.Texts("tells_apart"), table.RequiredText("controller"), table.RequiredText("words"),
                        table.Numbers("levels", {}, 1, kMostLevels, 0.0, 1e9),
                        table.RequiredNumber("dwell_s", 0.0, 1e6), table.Number("opening_per_pa", 1e-5, 0.0, 1.0)});
  root.Finish();
  return programs;
}

const Program& Choose(const std::vector<CandidatePtr>& candidates) {
  static const std::vector<Program> programs = ReadPrograms();
  const auto holds = [&](const std::string& effect) {
    return std::any_of(candidates.begin(), candidates.end(), [&](const CandidatePtr& candidate) {
      const auto names = candidate->names();
      return std::find(names.begin(), names.end(), effect) != names.end();
    });
  };
  return *std::find_if(programs.begin(), programs.end() - 1, [&](const Program& program) {
    return std::all_of(program.tells_apart.begin(), program.tells_apart.end(), holds);
  });
}

}  // namespace

Experiment ActuatorExperiment(const std::string& plant, const Signals& signals, const ActuatorConstants& constants,
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
  out << "# " << experiment.words << "\nschema = 1\nplant = \"" << plant
      << "\"\nduration_s = 20.0\nsample_interval_s = " << signals.dt << "\npack_period_s = " << 100.0 * signals.dt
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
