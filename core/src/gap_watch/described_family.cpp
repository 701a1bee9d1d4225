#include "armcmc/gap_watch/described_family.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "gap_tools.hpp"

namespace armcmc {
namespace {

using expression::SymbolKind;

constexpr double kSlowest = 0.1;    // share of the largest magnitude
constexpr double kEnd = 0.75;       // share of the range above which a value counts as its end
constexpr int kAfterReversal = 25;  // samples

/// Signals that are part of the target of a mode, in addition to the measured output.
std::vector<bool> ExplainedSignals(const Plant& plant) {
  std::vector<bool> explained(plant.description().signals.size(), false);
  const int output = plant.NodeOf(SymbolKind::kSignal, plant.output());
  for (const PlantMode& mode : plant.modes()) {
    if (mode.passive || mode.target == output) continue;
    for (std::size_t s = 0; s < explained.size(); ++s)
      explained[s] =
          explained[s] || plant.graph().DependsOn(mode.target, plant.NodeOf(SymbolKind::kSignal, static_cast<int>(s)));
  }
  return explained;
}

bool LawsAvoid(const Plant& plant, const std::vector<bool>& signals) {
  for (const PlantMode& mode : plant.modes())
    for (std::size_t s = 0; s < signals.size() && !mode.passive; ++s)
      if (signals[s] && plant.graph().DependsOn(mode.law, plant.NodeOf(SymbolKind::kSignal, static_cast<int>(s))))
        return false;
  return true;
}

/// Some passive mode has a law for the measured output.
bool APassiveModePredicts(const PlantProgram& program) {
  for (int m = 0; m < program.info().num_modes; ++m)
    if (!program.LawIsOutput(m)) return false;
  const auto& modes = program.plant().description().modes;
  return std::any_of(modes.begin(), modes.end(),
                     [](const ModeDescription& mode) { return mode.passive && !mode.law.empty(); });
}

}  // namespace

DescribedFamily::DescribedFamily(const PlantProgram& program, const std::vector<std::string>& probes) {
  const Plant& plant = program.plant();
  const PlantDescription& description = plant.description();
  const ModelInfo& info = program.info();
  judges_passive_ = APassiveModePredicts(program);
  trajectories_begin_anew_ = program.states().size() > 0;
  checks_.serial = kSerialChecks;
  Add(Kind::kEverywhere, 0, "everywhere");
  const std::vector<bool> explained = ExplainedSignals(plant);
  if (LawsAvoid(plant, explained)) {
    Add(Kind::kOutputRate, 0, "output_rate");
    Add(Kind::kHighOutput, 0, "high_output");
  }
  if (!probes.empty()) first_probe_ = checks_.num_regions;
  for (const std::string& name : probes) Add(Kind::kProbe, 0, name);
  const int num_modes = info.num_modes + (judges_passive_ ? 1 : 0);
  for (int m = 1; m < num_modes; ++m) Add(Kind::kInMode, m, "in_" + std::string(info.modes[At(m)]));
  const bool has_acceleration = !plant.SignalsWithRole("acceleration").empty();
  // Motion first: most missing effects of machines depend on it.
  for (const bool motion : {true, false}) {
    int input = 0;
    for (std::size_t s = 0; s < description.signals.size(); ++s) {
      if (static_cast<int>(s) == plant.output()) continue;
      const SignalDescription& signal = description.signals[s];
      if (!explained[s] && (signal.role == "velocity") == motion) AddInput(signal, input, has_acceleration);
      ++input;
    }
  }
}

void DescribedFamily::Add(Kind kind, int index, std::string name) {
  if (checks_.num_regions == kMaxRegions) return;
  Region& region = regions_[At(checks_.num_regions)];
  region = {kind, index, std::move(name)};
  checks_.regions[At(checks_.num_regions++)] = region.name;
}

void DescribedFamily::AddInput(const SignalDescription& signal, int input, bool has_acceleration) {
  const std::string& name = signal.name;
  if (signal.role == "velocity") {
    Add(Kind::kDirection, input, "direction_of_" + name);
    Add(Kind::kValue, input, name);
    Add(Kind::kSlow, input, "slow_" + name);
    Add(Kind::kReversal, input, "reversal_of_" + name);
    if (!has_acceleration) Add(Kind::kSlope, input, "slope_of_" + name);
    return;
  }
  Add(Kind::kHigh, input, "high_" + name);
  if (signal.role == "position") Add(Kind::kLow, input, "low_" + name);
  Add(Kind::kSquare, input, "square_of_" + name);
  if (signal.role != "position") Add(Kind::kValue, input, name);
}

double DescribedFamily::Value(Kind kind, double u, const RegionMemory::Input& input) noexcept {
  const double range = input.highest - input.lowest;
  const double largest = std::fmax(std::fabs(input.highest), std::fabs(input.lowest));
  switch (kind) {
    case Kind::kDirection: return Sign(u);
    case Kind::kValue: return u;
    case Kind::kSlow: return std::fabs(u) < kSlowest * largest ? Sign(u) : 0.0;
    case Kind::kReversal: return input.since_reversal < kAfterReversal ? Sign(u) : 0.0;
    case Kind::kSquare: return u * u;
    case Kind::kHigh: return u > input.lowest + kEnd * range ? 1.0 : 0.0;
    case Kind::kLow: return u < input.highest - kEnd * range ? 1.0 : 0.0;
    default: return 1.0;
  }
}

void DescribedFamily::Fill(const DataPack& pack, const std::array<int, kMaxPackSamples>& modes,
                           const double* prediction, RegionMemory* memory, RegionTemplates* out) const noexcept {
  std::array<double, kMaxPackInputs> slope{};
  for (int r = 0; r < checks_.num_regions; ++r)
    if (regions_[At(r)].kind == Kind::kSlope)
      slope[At(regions_[At(r)].index)] = MeanSlope(pack, At(regions_[At(r)].index));
  for (std::size_t n = 0; n < At(pack.num_samples); ++n) {
    for (std::size_t i = 0; i < At(pack.num_inputs); ++i) {
      RegionMemory::Input& input = memory->input[i];
      const double u = pack.u[n][i];
      input.lowest = input.seen ? std::fmin(input.lowest, u) : u;
      input.highest = input.seen ? std::fmax(input.highest, u) : u;
      input.since_reversal =
          input.seen && input.positive != (u > 0.0) ? 0 : std::min(input.since_reversal + 1, 1 << 20);
      input.positive = u > 0.0;
      input.seen = true;
    }
    if (n == 0 && trajectories_begin_anew_)
      memory->last_prediction = prediction[0] - (pack.num_samples > 1 ? prediction[1] - prediction[0] : 0.0);
    const double size = std::fabs(prediction[n]);
    memory->highest_prediction = std::fmax(memory->highest_prediction, size);
    for (int r = 0; r < checks_.num_regions; ++r) {
      const Region& region = regions_[At(r)];
      double& value = (*out)[At(r)][n];
      switch (region.kind) {
        case Kind::kEverywhere: value = 1.0; break;
        case Kind::kInMode: value = modes[n] == region.index ? 1.0 : 0.0; break;
        case Kind::kOutputRate: value = prediction[n] - memory->last_prediction; break;
        case Kind::kHighOutput: value = size > kHigh * memory->highest_prediction ? 1.0 : 0.0; break;
        case Kind::kProbe: break;
        case Kind::kSlope: value = slope[At(region.index)]; break;
        default: value = Value(region.kind, pack.u[n][At(region.index)], memory->input[At(region.index)]); break;
      }
    }
    memory->last_prediction = prediction[n];
  }
}

}  // namespace armcmc
