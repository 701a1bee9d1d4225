// What a described plant does where no scenario says it.

#include <algorithm>
#include <array>
#include <string_view>

#include "armcmc/plant_sim/described_simulation.hpp"

namespace armcmc::plant_sim {
namespace {

struct UsualMotion {
  std::string_view role, unit;
  double amplitude, offset, bandwidth_hz;
};

// In SI units; the first that fits. No unit: any.
constexpr std::array kUsualMotions = {
    UsualMotion{"position", "m", 0.02, 0.0, 2.0},      UsualMotion{"position", "rad", 0.5, 0.0, 2.0},
    UsualMotion{"velocity", "", 0.1, 0.0, 2.0},        UsualMotion{"pressure", "Pa", 5e4, 2e5, 2.0},
    UsualMotion{"force", "", 10.0, 0.0, 2.0},          UsualMotion{"level", "", 1.0, 2.0, 0.5},
    UsualMotion{"temperature", "", 10.0, 293.15, 0.1}, UsualMotion{"drive", "V", 1.0, 0.0, 5.0}};

InputProgram UsualInput(const DescribedPlant::Signal& signal) {
  InputProgram program;
  program.bandwidth_hz = 5.0;
  for (const UsualMotion& usual : kUsualMotions) {
    if (usual.role != signal.role || (!usual.unit.empty() && usual.unit != signal.unit)) continue;
    program.amplitude = usual.amplitude;
    program.offset = usual.offset;
    program.bandwidth_hz = usual.bandwidth_hz;
    break;
  }
  return program;
}

bool IsAState(const DescribedPlant& plant, const std::string& signal) {
  return std::any_of(plant.states.begin(), plant.states.end(), [&signal](const DescribedPlant::State& state) {
    return state.measured_by == signal || state.start == signal;
  });
}

}  // namespace

std::vector<std::string> InputsToMove(const DescribedPlant& plant) {
  std::vector<std::string> names;
  for (const DescribedPlant::Signal& signal : plant.signals)
    if (signal.name != plant.output && signal.derivative_of.empty() && !IsAState(plant, signal.name))
      names.push_back(signal.name);
  return names;
}

DescribedScenario UsualScenario(const DescribedPlant& plant) {
  DescribedScenario scenario;
  for (const std::string& name : InputsToMove(plant))
    scenario.inputs[name] = UsualInput(plant.signals[static_cast<std::size_t>(plant.SignalAt(name))]);
  return scenario;
}

}  // namespace armcmc::plant_sim
