#include <CLI/CLI.hpp>

#include "arguments.hpp"
#include "armcmc/support/program.hpp"
#include "runs.hpp"

int main(int argc, char** argv) {
  using namespace armcmc;
  CLI::App app{"Estimates the parameters of a recorded plant, pack by pack."};
  replay::Arguments arguments;
  replay::Declare(&app, &arguments);
  return support::RunProgram(app, "armcmc-replay", argc, argv, [&] {
    replay::Complete(&arguments);
    if (!arguments.calibrate.empty()) return replay::RunCalibration(arguments);
    if (arguments.compares()) return replay::RunComparison(arguments);
    return replay::RunEstimates(arguments);
  });
}
