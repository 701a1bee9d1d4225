#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/support/program.hpp"
#include "armcmc/support/progress.hpp"
#include "armcmc/support/scratch_folder.hpp"
#include "armcmc/tables/plants/registry.hpp"
#include "armcmc/tables/report.hpp"

namespace armcmc::tables {
namespace {

struct Arguments {
  std::string data, out;
  int seeds = 1;
  std::uint64_t first_seed = 1001;  // the baselines were tuned on others
  bool paper_only = false, likelihoods = false, coverage = false, drift = false, armcmc_only = false;
};

/// Simulates recordings in a folder of its own.
class Simulator {
 public:
  explicit Simulator(std::uint64_t first_seed) : first_seed_(first_seed) {}
  [[nodiscard]] Recording Simulated(const std::string& scenario, PlantNumber plant, double p_atm, int seed) const {
    const std::filesystem::path csv =
        Simulate(scenario, first_seed_ + static_cast<std::uint64_t>(seed), folder_.path());
    Recording r = ReadRecording(csv, plant, p_atm);
    std::filesystem::remove(csv);
    return r;
  }

 private:
  std::uint64_t first_seed_;
  support::ScratchFolder folder_{"armcmc-tables"};
};

struct Plan {
  std::string key, title, scenario, file;  // file: of --data, which replaces the scenario
};
const std::vector<Plan> kPlans = {
    {kContact.key(), std::string(kContact.experiment) + ", the paper's experiment", kContact.key("_paper"),
     kContact.key(".csv")},
    {kActuator.key(), std::string(kActuator.experiment) + ", the paper's experiment", kActuator.key("_paper"),
     kActuator.key(".csv")},
    {kActuator.key("_excited"), std::string(kActuator.experiment) + ", excited", kActuator.key("_excited"), ""},
    {kContact.key("_step"), "Contact: K halves at 8 s and recovers at 14.5 s", kContact.key("_step"), ""},
    {kContact.key("_drift"), "Contact: K, B and p drift from 2 s to 18 s", kContact.key("_drift"), ""},
    {kContact.key("_heavy_tailed"), "Contact: Student-t noise of three degrees of freedom",
     kContact.key("_heavy_tailed"), ""},
    {kContact.key("_impulsive"), "Contact: impulsive noise, one sample in twenty", kContact.key("_impulsive"), ""},
    {kContact.key("_chatter"), "Contact with chatter", kContact.key("_chatter"), ""}};

/// What else may drift, and how.
const std::vector<Plan> kDriftPlans = {
    {kContact.key("_drift_slow"), "Contact: a slow drift", kContact.key("_drift_slow"), ""},
    {kContact.key("_drift_fast"), "Contact: a fast drift", kContact.key("_drift_fast"), ""},
    {kContact.key("_drift_one"), "Contact: the stiffness drifts alone", kContact.key("_drift_one"), ""},
    {kContact.key("_drift_stops"), "Contact: a drift that stops", kContact.key("_drift_stops"), ""},
    {kContact.key("_drift_and_jump"), "Contact: a drift and a jump", kContact.key("_drift_and_jump"), ""},
    {kContact.key("_drift_sine"), "Contact: a sinusoidal drift", kContact.key("_drift_sine"), ""},
    {kContact.key("_drift_impulsive"), "Contact: a drift under impulsive noise", kContact.key("_drift_impulsive"), ""}};

Experiment RunPlan(const Plan& plan, const Arguments& a, const Simulator& simulator, Result* result) {
  const EstimatorSettings settings = ScenarioSettings(plan.scenario);
  const PlantNumber plant = kContact.Is(settings) ? kContact.model.plant : kActuator.model.plant;
  const double p_atm = ConstantOf(settings, "p_atm");
  const bool recorded = !a.data.empty() && !plan.file.empty();
  if (!plan.file.empty())
    (kContact.Is(plant) ? result->contact_data : result->actuator_data) =
        recorded ? plan.file + " of --data" : "the plant's own scenario " + plan.scenario;
  std::vector<MethodSpec> methods = PaperMethods(settings);
  if (a.armcmc_only) methods.resize(1);  // it is the first
  return RunExperiment(
      plan.key, plan.title, recorded ? 1 : a.seeds,
      [&](int seed) {
        return recorded ? ReadRecording(std::filesystem::path(a.data) / plan.file, plant, p_atm)
                        : simulator.Simulated(plan.scenario, plant, p_atm, seed);
      },
      methods);
}

void Write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

int Run(const Arguments& a) {
  if (!a.data.empty())
    for (const Plan& plan : kPlans)
      if (!plan.file.empty() && !std::filesystem::exists(std::filesystem::path(a.data) / plan.file))
        throw support::InputError("--data " + a.data + ": expected a folder with " + plan.file);
  std::filesystem::create_directories(a.out);
  const Simulator simulator(a.first_seed);
  Result result;
  result.baselines = !a.armcmc_only;
  {
    support::Progress progress("tables");
    std::vector<Plan> plans = a.coverage ? std::vector<Plan>{} : kPlans;
    if (a.drift) plans.insert(plans.end(), kDriftPlans.begin(), kDriftPlans.end());
    // The paper's scenario on fresh noise, when --data gave the one realisation and more seeds are asked for.
    if (!a.data.empty() && a.seeds > 1 && !a.coverage)
      plans.insert(plans.begin() + 1,
                   {kContact.key("_seeds"), std::string(kContact.experiment) + ", the paper's scenario, fresh noise",
                    kContact.key("_paper"), ""});
    if (a.paper_only) std::erase_if(plans, [](const Plan& p) { return p.file.empty(); });
    const int cells = a.likelihoods ? 16 : a.coverage ? 4 : 0;
    constexpr double kPlansPerCell = 0.25;  // a plan runs every method, a cell one
    const double all = static_cast<double>(plans.size()) + kPlansPerCell * cells;
    double done = 0.0;
    for (const Plan& plan : plans) {
      result.experiments.push_back(RunPlan(plan, a, simulator, &result));
      progress.Update((done += 1.0) / all);
    }
    if (cells > 0)
      result.likelihoods = RunLikelihoods(
          a.seeds, a.likelihoods ? AssumedLaws::kAll : AssumedLaws::kOwn,
          [&](const std::string& scenario, int seed) {
            return simulator.Simulated(scenario, kContact.model.plant, 0.0, seed);
          },
          [&] { progress.Update((done += kPlansPerCell) / all); });
  }
  const std::filesystem::path out = a.out;
  Write(out / "tables.json", ToJson(result).dump(2) + "\n");
  const std::string text = ToText(result);
  Write(out / "tables.txt", text);
  Write(out / "report.html", ToHtml(result));
  std::cout << text << "\nreport: " << (out / "report.html").string() << '\n';
  return support::kExitOk;
}

}  // namespace
}  // namespace armcmc::tables

int main(int argc, char** argv) {
  CLI::App app{
      "Runs every method on the paper's two experiments, with the same data: tables, tables.json, report.html."};
  armcmc::tables::Arguments a;
  CLI::Option* data =
      app.add_option("--data", a.data,
                     "Folder with " + armcmc::tables::kContact.key(".csv") + " (t,x,v,f,f_true) and " +
                         armcmc::tables::kActuator.key(".csv") +
                         " "
                         "(t,u_c,u_d,p,pdot,alpha,flow,theta1_true,theta2_true). Default: armcmc-plant simulates them")
          ->type_name("DIR");
  app.add_option("--out", a.out, "Folder for the results")->type_name("DIR")->required();
  app.add_option("--seeds", a.seeds, "Noise realisations of every simulated scenario; tables show means")
      ->type_name("N")
      ->check(CLI::Range(1, 1000));
  app.add_option("--first-seed", a.first_seed, "Seed of the first realisation; the others follow")
      ->type_name("N")
      ->capture_default_str();
  CLI::Option* paper_only = app.add_flag("--paper-only", a.paper_only, "Only the paper's two experiments");
  CLI::Option* likelihoods = app.add_flag(
      "--likelihoods", a.likelihoods, "Also the coverage with matching and mismatched noise laws (16 runs per seed)");
  app.add_flag("--armcmc-only", a.armcmc_only, "Skip the baselines, which take nine tenths of the time");
  CLI::Option* drift = app.add_flag("--drift", a.drift, "Also seven more scenarios with drifting parameters");
  app.add_flag(
         "--coverage", a.coverage,
         "Only the coverage of each noise law with its own likelihood: many seeds in little time (4 runs per seed)")
      ->excludes(data)
      ->excludes(paper_only)
      ->excludes(drift)
      ->excludes(likelihoods);
  app.footer(
      "Example:\n"
      "  armcmc-tables --out tables\n"
      "  armcmc-tables --seeds 20 --likelihoods --drift --out tables\n"
      "  armcmc-tables --coverage --seeds 300 --first-seed 40001 --out coverage\n"
      "Exit status: 0 ok, 2 bad usage or input, 1 any other failure.");
  return armcmc::support::RunProgram(app, "armcmc-tables", argc, argv, [&a] { return armcmc::tables::Run(a); });
}
