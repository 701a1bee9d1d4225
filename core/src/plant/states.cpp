#include "armcmc/plant/states.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "armcmc/expression/compile.hpp"
#include "plant/runge_kutta.hpp"

namespace armcmc {
namespace {

using expression::Graph;

static_assert(Plant::kMaxStates == kMaxStates);

constexpr int kSmallestPack = 64;  ///< Samples for which a plant with states must have room.
constexpr int kMaxStepInstructions = 2048;
constexpr int kMaxStepScalars = 200;
constexpr int kMaxStepInputs = 64;  ///< Of the rates, at one point.

}  // namespace

PlantStates::PlantStates(const Plant& plant, expression::Graph* graph, const std::vector<int>& rates,
                         const std::vector<int>& starts, const std::vector<RememberedState>& remembered,
                         const std::vector<bool>& held_inputs, int num_parameters, std::vector<int>* scalars)
    : size_(static_cast<int>(rates.size())) {
  all_measured_ = true;
  const auto& signals = plant.description().signals;
  for (std::size_t s = 0; s < signals.size(); ++s) between_[s] = BetweenNamed(signals[s].between);
  for (std::size_t i = 0; i < held_inputs.size(); ++i)
    if (held_inputs[i]) between_[PlantPoint::kFirstRemembered + i] = Between::kHeld;
  const int output = plant.NodeOf(expression::SymbolKind::kSignal, plant.output());
  for (std::size_t s = 0; s < rates.size(); ++s) {
    const bool of_plant = s < plant.states().size();
    measured_by_[s] = of_plant ? plant.states()[s].measured_by : -1;
    all_measured_ = all_measured_ && measured_by_[s] >= 0;
    const bool is_state = of_plant || remembered[s - plant.states().size()].late >= 0;
    given_start_[s] = is_state && measured_by_[s] < 0 && !graph->at(starts[s]).sampled;
    const int slope = measured_by_[s] < 0 ? graph->Differentiate(starts[s], output) : -1;
    output_in_start_[s] = measured_by_[s] == plant.output()      ? 1.0
                          : slope >= 0 && graph->IsNumber(slope) ? graph->at(slope).value
                                                                 : 0.0;
    // One step for all: they are one system.
    if (of_plant) substeps_ = std::max(substeps_, plant.description().states[s].substeps);
  }
  const auto guarded = [](const char* what, const auto& work) {
    try {
      work();
    } catch (const std::logic_error& error) {  // length_error, invalid_argument
      throw PlantError("states", 0, std::string(what) + error.what());
    }
  };
  guarded("the start of the states ", [&] {
    const expression::CompiledTape tape = CompileTape(graph, starts, {.num_parameters = num_parameters});
    *scalars = tape.scalars;
    start_ = tape.tape;
  });
  guarded("the rates of the states ", [&] { CompileStep(graph, rates, remembered, num_parameters); });
  if (substeps_ * kSmallestPack * step_.num_scalars > kMaxStateCells)
    throw PlantError("states", 0,
                     "a step of their rates needs " + std::to_string(step_.num_scalars) +
                         " quantities of signals, and " + std::to_string(substeps_) +
                         " steps a sample exceed the limit: use fewer substeps");
}

void PlantStates::CompileStep(Graph* graph, const std::vector<int>& rates,
                              const std::vector<RememberedState>& remembered, int num_parameters) {
  RungeKutta method(graph, rates);
  if (method.inputs().size() > kMaxStepInputs)
    throw std::length_error("need more than " + std::to_string(kMaxStepInputs) +
                            " different quantities that depend on no parameter");
  for (const int node : method.inputs())
    if (graph->at(node).memory) throw std::invalid_argument("depend on samples before, through their modes");
  inputs_ = expression::FeatureProgram(*graph, method.inputs());
  expression::TapeLayout layout{.num_parameters = num_parameters,
                                .num_states = size_,
                                .advances = true,
                                .most_instructions = kMaxStepInstructions,
                                .most_scalars = kMaxStepScalars};
  std::vector<int> results = method.Staged();
  method.MakeExact(remembered, &results);
  layout.first = method.stages();
  expression::CompiledTape tape = CompileTape(graph, results, layout);
  if (std::vector<int> linear = method.Linear(); !linear.empty()) {
    method.MakeExact(remembered, &linear);
    layout.first.clear();
    expression::CompiledTape short_tape = CompileTape(graph, linear, layout);
    if (short_tape.tape.size() < tape.tape.size()) tape = std::move(short_tape);
  }
  step_ = tape.tape;
  scalars_ = expression::FeatureProgram(*graph, tape.scalars);
}

bool PlantStates::Prepare(const DataPack& pack, const PlantPoint::Values* point, const StateMemory* before,
                          StateRun* out) const noexcept {
  out->step = size_ > 0 ? &step_ : nullptr;
  if (size_ == 0) return true;
  out->start = &start_;
  out->num_states = size_;
  out->num_samples = pack.num_samples;
  out->substeps = substeps_;
  out->stride = step_.num_scalars;
  const bool carried = before != nullptr && before->known && !all_measured_;
  out->carried = carried;
  const int intervals = pack.num_samples - 1 + (carried ? 1 : 0);
  if (intervals * substeps_ * out->stride > kMaxStateCells) return false;

  const PlantPoint::Values& start = carried ? before->point : point[0];
  PlantPoint::Values between{};
  bool finite = true;
  for (std::size_t s = 0; s < static_cast<std::size_t>(size_); ++s) {
    const int signal = measured_by_[s];
    out->given[s] = carried || signal >= 0;
    out->value[s] = signal >= 0 ? start[static_cast<std::size_t>(signal)] : carried ? before->state[s] : 0.0;
    finite = finite && std::isfinite(out->value[s]);
  }
  const double first_t = pack.t_last_s - intervals * pack.dt;
  const int points = 2 * substeps_;
  const auto width = static_cast<std::size_t>(inputs_.num_outputs());
  std::array<double, 1 + 3 * kMaxStepInputs> given{};  // h, then the inputs at the three points
  given[0] = pack.dt / substeps_;
  for (int i = 0; i < intervals; ++i) {
    const int n = i - (carried ? 1 : 0);  // sample at the beginning of the interval
    const PlantPoint::Values &from = n < 0 ? start : point[n], &to = point[n + 1];
    const bool has_earlier = i > 0, has_later = n + 2 < pack.num_samples;
    const PlantPoint::Values &earlier = n > 0 ? point[n - 1] : start, &later = point[has_later ? n + 2 : n + 1];
    for (int p = 0; p <= points; ++p) {
      const double part = static_cast<double>(p) / points;
      for (std::size_t s = 0; s < between.size(); ++s)
        between[s] = ValueBetween(between_[s], has_earlier ? &earlier[s] : nullptr, from[s], to[s],
                                  has_later ? &later[s] : nullptr, part);
      inputs_.Evaluate({between.data(), first_t + (i + part) * pack.dt, pack.dt}, nullptr,
                       given.data() + 1 + static_cast<std::size_t>(p == 0 ? 0 : 2 - p % 2) * width);
      if (p == 0 || p % 2 == 1) continue;
      scalars_.Evaluate({given.data(), 0.0, pack.dt}, nullptr, out->Row(i * substeps_ + p / 2 - 1));
      std::copy_n(given.begin() + 1 + static_cast<std::ptrdiff_t>(2 * width), width, given.begin() + 1);
    }
  }
  return finite;
}

}  // namespace armcmc
