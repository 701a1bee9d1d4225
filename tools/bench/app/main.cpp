#include <benchmark/benchmark.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <vector>

#include "armcmc/bench/peer_case.hpp"
#include "armcmc/bench/suite.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/scratch_folder.hpp"

namespace {

struct Arguments {
  std::vector<std::string> models;
  std::string instruction_set;
  bool no_quality = false;
  std::string write_packs;
  int replicates = 200;
};

void Declare(CLI::App* app, Arguments* a) {
  app->add_option(
         "--model", a->models,
         "Only this plant: a built-in one, NAME:tape for the same as a plant file, the name of a bundled plant, "
         "or a file. May be repeated")
      ->type_name("NAME");
  app->add_option("--instruction-set", a->instruction_set,
                  "avx512, avx2 or sse2 (on AArch64 neon or portable) instead of the widest that this CPU supports")
      ->type_name("NAME");
  app->add_flag("--no-quality", a->no_quality, "Skip BM_EffectiveDraws");
  app->add_option(
         "--write-packs", a->write_packs,
         "Run no benchmark; write the packs of BM_EffectiveDraws that start from the prior to this folder, for other "
         "programs, with the posterior by quadrature and replicates of the estimator's result")
      ->type_name("DIR");
  app->add_option("--replicates", a->replicates, "Replicates for --write-packs (200)")
      ->type_name("N")
      ->check(CLI::Range(1, 100000));
  app->allow_extras();
  app->footer(
      "Times each part of the estimator's step on packs that armcmc-plant simulates with a fixed seed, and measures\n"
      "the effective sample size of its draws. Accepts every option of Google Benchmark as well:\n"
      "--benchmark_filter=REGEX, --benchmark_format=json, --benchmark_out=FILE, --benchmark_repetitions=N,\n"
      "--benchmark_list_tests. Times on a shared machine vary: compare only figures from the same run.\n\n"
      "Benchmarks:\n"
      "  BM_AdjustStep/PLANT/DRAWS/SAMPLES   draw and remember; BM_Draw, BM_Remember and BM_Execute are the parts\n"
      "  BM_Dimension/PARAMETERS             draw and remember for plant files with 2 to 6 parameters\n"
      "  BM_Score/PLANT                      the likelihood of all candidates alone, sample by sample\n"
      "  BM_Memory/PLANT                     construction; the counter `bytes` is the heap that it takes\n"
      "  BM_EverySample/PLANT/DRAWS/SAMPLES  BM_AdjustStep with every candidate scored sample by sample\n"
      "  BM_Noise/PLANT/LAW                  a whole step with another noise law\n"
      "  BM_Effects/PLANT/COUNT              a whole step with effects added to the law\n"
      "  BM_NaiveLoop/DRAWS/SAMPLES          the likelihood alone, as a plain loop with std::pow\n"
      "  BM_EffectiveDraws/CASE              200 replicates: posterior variance over that of the estimated mean,\n"
      "                                      of the chain and of the weighted draws\n\n"
      "Examples:\n"
      "  armcmc-bench --benchmark_filter=AdjustStep\n"
      "  armcmc-bench --model my_axis.toml --benchmark_format=json\n"
      "  armcmc-bench --write-packs packs\n"
      "Exit status: 0 ok, 2 bad usage or input, 1 any other failure.");
}

int Run(const CLI::App& app, const Arguments& a, const std::string& program) {
  if (!a.instruction_set.empty() && !armcmc::UseInstructionSet(a.instruction_set))
    throw armcmc::support::InputError(
        "--instruction-set " + a.instruction_set +
        ": not of this build or this CPU; there are avx512, avx2, sse2, and on AArch64 neon, portable");
  if (!a.write_packs.empty()) {
    if (!app.remaining().empty())
      throw armcmc::support::InputError(app.remaining().front() + ": no option of --write-packs (see --help)");
    armcmc::bench::WritePeerCases(a.write_packs, a.replicates);
    return armcmc::support::kExitOk;
  }
  std::vector<std::string> words = app.remaining();
  words.insert(words.begin(), program);
  std::vector<char*> argv;
  argv.reserve(words.size());
  for (std::string& word : words) argv.push_back(word.data());
  int argc = static_cast<int>(argv.size());
  benchmark::Initialize(&argc, argv.data());
  if (argc > 1) throw armcmc::support::InputError(std::string(argv[1]) + ": no such option (see --help)");
  const armcmc::support::ScratchFolder folder("armcmc-bench");
  armcmc::bench::Suite suite = armcmc::bench::MakeSuite(a.models);
  suite.quality = !a.no_quality;
  armcmc::bench::Register(suite, folder.path());
  benchmark::AddCustomContext("instruction_set", std::string(armcmc::InstructionSet()));
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return armcmc::support::kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Measures the time of the estimator's step and the quality of its draws."};
  Arguments arguments;
  Declare(&app, &arguments);
  return armcmc::support::RunProgram(
      app, "armcmc-bench", argc, argv, [&] { return Run(app, arguments, argv[0]); }, armcmc::support::Output::kColours);
}
