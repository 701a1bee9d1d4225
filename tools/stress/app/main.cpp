#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "armcmc/stress/files.hpp"
#include "armcmc/stress/load.hpp"
#include "armcmc/stress/phase.hpp"
#include "armcmc/stress/report.hpp"
#include "armcmc/stress/verdict.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/progress.hpp"
#include "armcmc/support/scratch_folder.hpp"

namespace {

using namespace armcmc::stress;

constexpr char kName[] = "armcmc-stress";
constexpr char kDescription[] =
    "Runs the actual plant and estimator programs under load, injects faults, and checks for each one whether and\n"
    "how it was detected, and after how many steps operation was normal again.";
constexpr char kFooter[] =
    "Loads: none, cpu, memory, io, net (messages on the same port), watchers (lcm-logger, lcm-spy); the time is\n"
    "divided among them. Adapt --period-ms, --deadline-ms and --draws to the machine.\n"
    "Examples:\n"
    "  armcmc-stress --minutes 2 --report stress.json --html stress.html\n"
    "  armcmc-stress --minutes 480 --period-ms 10\n"
    "  armcmc-stress --minutes 1 --period-ms 1 --draws 1000 --samples 20 --load none --inject none\n"
    "Exit status: 0 passed, 1 not passed or not run, 2 bad usage.";

struct Arguments {
  StressOptions options;
  std::string loads = "none,cpu,memory,io,net,watchers";
  std::string faults = "all";
  std::string report, html, generate, work;
};

void CheckWritable(const std::string& path) {
  if (path.empty()) return;
  const auto folder = std::filesystem::absolute(path).parent_path();
  if (!std::filesystem::is_directory(folder)) {
    throw armcmc::support::InputError(path + ": expected a file in a folder that exists");
  }
}

int Stress(Arguments arguments) {
  StressOptions& options = arguments.options;
  CheckWritable(arguments.report);
  CheckWritable(arguments.html);
  options.loads = SelectLoads(arguments.loads);
  options.faults = SelectFaults(arguments.faults);
  options.programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  // Two buses of LCM on one port are one bus: every run has a port of its own.
  if (options.lcm_url.empty()) {
    options.lcm_url =
        "udpm://239.255.76.67:" + std::to_string(20'000 + getpid() % 10'000) + "?ttl=0&recv_buf_size=4194304";
  }
  const bool own_folder = arguments.work.empty();
  if (own_folder) {
    armcmc::support::ScratchFolder logs("armcmc-stress");
    logs.Keep();  // those of a run that fails or stops half-way are wanted
    options.work = logs.path();
  } else {
    options.work = std::filesystem::absolute(arguments.work);
  }
  std::filesystem::create_directories(options.work);

  const double seconds = 60.0 * options.minutes / static_cast<double>(options.loads.size());
  std::size_t first = 0;
  std::vector<PhaseResult> phases;
  {
    armcmc::support::Progress bar("stress");
    for (std::size_t i = 0; i < options.loads.size(); ++i) {
      const auto n = static_cast<double>(options.loads.size());
      phases.push_back(RunPhase(options, options.loads[i], seconds, first,
                                [&](double share) { bar.Update((static_cast<double>(i) + share) / n); }));
      first += phases.back().slots_per_run;
      bar.Note("phase " + std::to_string(i + 1) + " of " + std::to_string(options.loads.size()) + ", " +
               PhaseLine(phases.back()));
      if (!arguments.report.empty()) WriteText(arguments.report, ReportJson(options, phases));
    }
  }
  std::cout << ReportText(options, phases);
  if (!arguments.html.empty()) WriteText(arguments.html, ReportHtml(options, phases));
  const bool passed = Judge(phases).passed;
  if (own_folder && passed) {
    std::filesystem::remove_all(options.work);
  } else {
    std::cout << "logs: " << options.work.string() << '\n';
  }
  return passed ? armcmc::support::kExitOk : armcmc::support::kExitFailure;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  StressOptions& options = arguments.options;
  CLI::App cli{kDescription};
  cli.footer(kFooter);
  cli.add_option("--minutes", options.minutes, "Total duration")
      ->type_name("MIN")
      ->capture_default_str()
      ->check(CLI::Range(0.05, 100'000.0));
  cli.add_option("--load", arguments.loads, "Loads, comma separated")->capture_default_str()->type_name("LIST");
  cli.add_option("--inject", arguments.faults, "Faults, comma separated, or all, or none")
      ->capture_default_str()
      ->type_name("LIST");
  cli.add_option("--period-ms", options.period_ms, "Time between packs")
      ->type_name("MS")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1000.0));
  cli.add_option("--deadline-ms", options.deadline_ms, "From release to estimate. Default: the period")
      ->type_name("MS")
      ->check(CLI::Range(0.1, 10'000.0));
  cli.add_option("--draws", options.draws, "Draws per pack: chernoff, k_min or a number")
      ->type_name("N")
      ->capture_default_str()
      ->check(CLI::IsMember({"chernoff", "k_min"}) | CLI::Range(100, 150'000));
  cli.add_option("--samples", options.samples, "Samples in a pack")
      ->type_name("N")
      ->capture_default_str()
      ->check(CLI::Range(5, 256));
  cli.add_option("--report", arguments.report, "Write a JSON report")->type_name("FILE");
  cli.add_option("--html", arguments.html, "Write an HTML page with the latencies")->type_name("FILE");
  cli.add_option("--lcm-url", options.lcm_url, "LCM bus. Default: a separate port")->type_name("URL");
  cli.add_option("--prefix", options.prefix, "Prefix of every channel name")->capture_default_str()->type_name("P");
  cli.add_option("--work", arguments.work, "Folder for logs. Default: a temporary one")->type_name("DIR");
  cli.add_option("--generate", arguments.generate)->group("");  // this program as a generator of load
  return armcmc::support::RunProgram(cli, kName, argc, argv, [&arguments] {
    if (!arguments.generate.empty()) {
      return GenerateLoad(arguments.generate, arguments.options.lcm_url, arguments.work);
    }
    return Stress(arguments);
  });
}
