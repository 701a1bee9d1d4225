#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "armcmc/gap_bench/report.hpp"
#include "armcmc/gap_bench/run.hpp"
#include "armcmc/gap_bench/strata.hpp"
#include "armcmc/gap_bench/summary.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/subprocess.hpp"

namespace armcmc::gap_bench {
namespace {

constexpr const char* kTies = "ties";

struct Arguments {
  std::vector<std::string> strata;
  int logs_per_cell = 1, jobs = 1;
  std::uint64_t seed = 1;
  std::string out, plant, recordings;
  bool keep = false;
};

void Declare(CLI::App* app, Arguments* a) {
  std::string known;
  for (const std::string& name : StratumNames()) known += name + ", ";
  app->add_option("--strata", a->strata,
                  "Comma separated, of: " + known + kTies + " (default: all; recorded needs --recordings)")
      ->type_name("NAME")
      ->delimiter(',');
  app->add_option("--logs-per-cell", a->logs_per_cell, "Recordings for each effect, strength and motion")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app->add_option("--seed", a->seed, "Seed of everything random: the same seed gives the same recordings")
      ->type_name("N")
      ->capture_default_str();
  app->add_option("--jobs", a->jobs, "Recordings to process in parallel")
      ->type_name("N")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app->add_option("--out", a->out, "Folder for bench.json, report.html and the generated scenarios")
      ->type_name("DIR")
      ->required();
  app->add_option("--plant", a->plant, "armcmc-plant (default: the one beside this program)")->type_name("FILE");
  app->add_option("--recordings", a->recordings, "Folder of real recordings, for the stratum recorded")
      ->type_name("DIR");
  app->add_flag("--keep", a->keep, "Keep recordings and sealed files");
  app->footer(
      "A blind test of the gap workflow: armcmc-plant, a separate process, hides an effect in a recording and writes\n"
      "the truth to a sealed file; the workflow reads the recording; then the file is opened and the answer scored.\n"
      "Stratum ties: for every ambiguous answer in the other strata, the proposed experiment is run and diagnosed.\n\n"
      "Example:\n  armcmc-gap-bench --strata null,singles --logs-per-cell 2 --jobs 2 --out bench\n"
      "Exit status: 0 all gates passed, 3 a gate failed, 2 bad usage or input, 1 any other failure.");
}

void Write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw support::InputError(path.string() + ": cannot be written");
}

std::vector<Outcome> RunAll(const PlantProcess& plant, const std::vector<Case>& cases, const Arguments& a) {
  std::size_t ended = 0;
  return RunCases(plant, cases, a.jobs, a.keep, [&](const Outcome& outcome) {
    std::fprintf(stderr, "[%zu/%zu] %s\n", ++ended, cases.size(), Line(outcome).c_str());
  });
}

int Run(Arguments a) {
  constexpr int kGateFailed = 3;
  if (a.strata.empty()) {
    a.strata = StratumNames();
    if (a.recordings.empty()) std::erase(a.strata, kRecorded);
    a.strata.emplace_back(kTies);
  }
  if (a.plant.empty()) a.plant = support::SiblingProgram("armcmc-plant");
  if (!std::filesystem::exists(a.plant)) throw support::InputError(a.plant + " does not exist: give --plant");
  const PlantProcess plant(a.plant, a.out);
  std::vector<Case> cases;
  for (const std::string& stratum : a.strata) {
    if (stratum == kTies) continue;
    std::vector<Case> more = CasesOf(stratum, a.logs_per_cell, a.seed, plant.folder(), a.recordings);
    cases.insert(cases.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  }
  std::vector<Outcome> outcomes = RunAll(plant, cases, a);
  if (std::find(a.strata.begin(), a.strata.end(), kTies) != a.strata.end()) {
    cases.clear();
    for (const Outcome& outcome : outcomes)
      if (CanFollowUp(outcome)) cases.push_back(FollowUp(plant, outcome));
    std::vector<Outcome> resolved = RunAll(plant, cases, a);
    outcomes.insert(outcomes.end(), std::make_move_iterator(resolved.begin()), std::make_move_iterator(resolved.end()));
  }
  Write(plant.folder() / "bench.json", ToJson(outcomes, a.seed).dump(1) + "\n");
  Write(plant.folder() / "report.html", Html(outcomes, a.seed));
  std::cout << Tables(outcomes) << "\nresult: " << (plant.folder() / "bench.json").string()
            << "\nreport: " << (plant.folder() / "report.html").string() << '\n';
  const std::vector<Gate> gates = Gates(outcomes);
  const bool passed = std::all_of(gates.begin(), gates.end(), [](const Gate& gate) { return gate.passed(); });
  return passed ? support::kExitOk : kGateFailed;
}

}  // namespace
}  // namespace armcmc::gap_bench

int main(int argc, char** argv) {
  CLI::App app{"Measures how well hidden effects are found."};
  armcmc::gap_bench::Arguments arguments;
  armcmc::gap_bench::Declare(&app, &arguments);
  return armcmc::support::RunProgram(app, "armcmc-gap-bench", argc, argv,
                                     [&] { return armcmc::gap_bench::Run(arguments); });
}
