#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/data_pack_v2_t.hpp"
#include "described_files.hpp"

namespace armcmc::plant_sim {
namespace {

using support::StrictTable;

constexpr double kLargest = std::numeric_limits<double>::max();
constexpr double kFastest = 1e6;  // Hz

InputProgram ReadInput(StrictTable at) {
  using Kind = InputProgram::Kind;
  InputProgram program;
  for (const auto& [key, kind] : {std::pair("expression", Kind::kExpression), std::pair("state", Kind::kState)}) {
    if (!at.Has(key)) continue;
    program.kind = kind;
    program.text = at.RequiredText(key);
    return program;  // any other key is then refused as unknown
  }
  const std::string kind = at.RequiredChoice("kind", {"multisine", "sine", "chirp", "steps"});
  program.amplitude = at.RequiredNumber("amplitude", 0.0, kLargest);
  program.offset = at.Number("offset", 0.0, -kLargest, kLargest);
  if (kind != "multisine")
    program.frequency_hz = kind == "chirp" ? at.Number("frequency_hz", 0.0, 0.0, kFastest)
                                           : at.RequiredNumber("frequency_hz", 1e-6, kFastest);
  if (kind == "multisine" || kind == "chirp") program.bandwidth_hz = at.RequiredNumber("bandwidth_hz", 1e-6, kFastest);
  if (kind == "sine") program.kind = Kind::kSine;
  if (kind == "chirp") program.kind = Kind::kChirp;
  if (kind == "steps") program.kind = Kind::kSteps;
  return program;
}

NoiseLaw ReadNoiseLaw(StrictTable at) {
  NoiseLaw law;
  const std::string name = at.RequiredChoice("law", {"gaussian", "student_t", "laplace", "mixture", "none"});
  for (const NoiseKind kind : {NoiseKind::kGaussian, NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture})
    if (name == NoiseKindName(kind)) law.kind = kind;
  if (law.kind != NoiseKind::kNone) law.std = at.RequiredNumber("std", 0.0, kLargest);
  return law;
}

HiddenTerm ReadHidden(StrictTable at) {
  HiddenTerm term;
  const std::string slot = at.RequiredText("slot");
  term.value = at.RequiredText("value");
  const std::size_t colon = slot.find(':');
  const std::string kind = slot.substr(0, colon);
  if (colon != std::string::npos) term.of = slot.substr(colon + 1);
  if (kind == "input" && !term.of.empty()) {
    term.slot = HiddenTerm::Slot::kInput;
  } else if (kind == "rate" && !term.of.empty()) {
    term.slot = HiddenTerm::Slot::kRate;
  } else if (slot != "output") {
    throw at.Error("slot", "expected \"output\", \"input:NAME\" or \"rate:STATE\", found \"" + slot + '"');
  }
  return term;
}

}  // namespace

DescribedScenario ReadDescribedScenario(StrictTable root) {
  constexpr double kLongest = 1e6;  // s
  constexpr std::int64_t kMaxSeed = 1'000'000'000;
  constexpr std::size_t kMostModes = 16;
  DescribedScenario scenario;
  root.RequireSchema();
  scenario.dt = 1.0 / root.Number("rate_hz", 1000.0, 1e-6, kFastest);
  scenario.duration_s = root.Number("duration_s", scenario.duration_s, 1e-6, kLongest);
  scenario.seed = static_cast<std::uint64_t>(root.Integer("seed", 1, 0, kMaxSeed));
  scenario.pack_stride = static_cast<int>(root.Integer("pack_stride", 0, 1, data_pack_v2_t::MAX_SAMPLES));
  StrictTable truth = root.Table("truth");
  for (const std::string& name : truth.Keys()) {
    try {
      scenario.truth[name] = truth.Numbers(name, {}, 1, kMostModes, -kLargest, kLargest);
    } catch (const support::ConfigError&) {
      scenario.truth[name] = {truth.RequiredNumber(name, -kLargest, kLargest)};
    }
  }
  StrictTable inputs = root.Table("inputs");
  for (const std::string& name : inputs.Keys()) scenario.inputs[name] = ReadInput(inputs.Table(name));
  StrictTable start = root.Table("start");
  for (const std::string& name : start.Keys()) scenario.start[name] = start.RequiredNumber(name, -kLargest, kLargest);
  if (root.Has("noise")) scenario.noise = ReadNoiseLaw(root.Table("noise"));
  for (StrictTable& hidden : root.Tables("hidden")) scenario.hidden.push_back(ReadHidden(hidden));
  root.Finish();
  return scenario;
}

}  // namespace armcmc::plant_sim
