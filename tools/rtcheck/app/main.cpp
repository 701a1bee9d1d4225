#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <vector>

#include "armcmc/rt/cpu_wake_request.hpp"
#include "armcmc/rt/settings.hpp"
#include "armcmc/rtcheck/findings.hpp"
#include "armcmc/support/program.hpp"

namespace {

using namespace armcmc::rtcheck;

constexpr int kExitNotFit = 3;

struct Arguments {
  Demand demand;
  double deadline_ms = 0.0;
  double seconds = 5.0;
  std::string root = "/";
  bool json = false;
};

int Check(Arguments arguments) {
  Demand& demand = arguments.demand;
  demand.deadline_ms = arguments.deadline_ms > 0.0 ? arguments.deadline_ms : demand.period_ms;
  const SystemRoot root(arguments.root);
  std::vector<Finding> findings = CheckProcess(root);
  for (const auto& part : {CheckCpu(root, demand), CheckSystem(root)})
    findings.insert(findings.end(), part.begin(), part.end());
  WakeUps wake_ups;
  const bool measured = arguments.seconds > 0.0;
  if (measured) {
    // As the estimator does: what is measured is what it will meet.
    armcmc::rt::CpuWakeRequest wake_request;
    if (demand.period_ms * 1e6 < static_cast<double>(armcmc::rt::RtSettings::kAwakeBelowNs)) (void)wake_request.Hold();
    wake_ups = MeasureWakeUps(demand.cpu, arguments.seconds);
    findings.push_back(CheckWakeUps(wake_ups, demand));
  }
  const WakeUps* shown = measured ? &wake_ups : nullptr;
  std::cout << (arguments.json ? ReportJson(findings, shown, demand) : ReportText(findings, shown, demand));
  return IsFit(findings) ? armcmc::support::kExitOk : kExitNotFit;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App cli{
      "Checks whether this computer can meet the deadlines. Examines privileges, kernel, processors, timers, memory\n"
      "and network, measures how late a real-time thread is woken, and gives the command that fixes each finding."};
  cli.footer(
      "Exit status: 0 suitable, 3 not suitable, 2 bad usage, 1 any other failure.\n"
      "Example: armcmc-rtcheck --period-ms 10 --seconds 60");
  cli.add_option("--period-ms", arguments.demand.period_ms, "Time between packs")
      ->type_name("MS")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 10'000.0));
  cli.add_option("--deadline-ms", arguments.deadline_ms, "From release to estimate. Default: the period")
      ->type_name("MS")
      ->check(CLI::Range(0.01, 100'000.0));
  cli.add_option("--cpu", arguments.demand.cpu, "CPU of the adjust stage")
      ->type_name("N")
      ->capture_default_str()
      ->check(CLI::Range(0, 1023));
  cli.add_option("--seconds", arguments.seconds, "How long to measure wake-ups; 0: not at all")
      ->type_name("S")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e6));
  cli.add_option("--root", arguments.root, "Folder that holds proc, sys and dev")
      ->capture_default_str()
      ->type_name("DIR");
  cli.add_flag("--json", arguments.json, "Print JSON instead of text");
  return armcmc::support::RunProgram(cli, "armcmc-rtcheck", argc, argv, [&arguments] { return Check(arguments); });
}
