#include "armcmc/plant/states.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "armcmc/expression/compile.hpp"

namespace armcmc {
namespace {

static_assert(Plant::kMaxStates == kMaxStates);

constexpr int kSmallestPack = 64;  ///< Samples for which a plant with states must have room.

}  // namespace

PlantStates::PlantStates(const Plant& plant, expression::Graph* graph, const std::vector<int>& rates,
                         const std::vector<int>& starts, int num_parameters, std::vector<int>* scalars)
    : size_(static_cast<int>(plant.states().size())), output_(plant.output()) {
  all_measured_ = true;
  for (std::size_t s = 0; s < plant.states().size(); ++s) {
    measured_by_[s] = plant.states()[s].measured_by;
    all_measured_ = all_measured_ && measured_by_[s] >= 0;
    const int output = plant.NodeOf(expression::SymbolKind::kSignal, output_);
    const int slope = measured_by_[s] < 0 ? graph->Differentiate(starts[s], output) : -1;
    output_in_start_[s] = measured_by_[s] == output_             ? 1.0
                          : slope >= 0 && graph->IsNumber(slope) ? graph->at(slope).value
                                                                 : 0.0;
    // One step for all: they are one system.
    substeps_ = std::max(substeps_, plant.description().states[s].substeps);
  }
  const auto guarded = [](const char* what, const auto& work) {
    try {
      work();
    } catch (const std::logic_error& error) {  // length_error, invalid_argument
      throw PlantError("states", 0, std::string(what) + error.what());
    }
  };
  guarded("the start of the states ", [&] {
    const expression::CompiledTape tape = CompileTape(graph, starts, num_parameters, 0, std::move(*scalars));
    *scalars = tape.scalars;
    start_ = tape.tape;
  });
  guarded("the rates of the states ", [&] {
    const expression::CompiledTape tape = CompileTape(graph, rates, num_parameters, size_);
    for (const int node : tape.scalars)
      if (graph->at(node).memory) throw std::invalid_argument("depend on samples before, through their modes");
    rate_ = tape.tape;
    features_ = expression::FeatureProgram(*graph, tape.scalars);
  });
  if ((2 * substeps_ * kSmallestPack + 1) * rate_.num_scalars > kMaxStateCells)
    throw PlantError("states", 0,
                     "the rates need " + std::to_string(rate_.num_scalars) + " quantities of signals at " +
                         std::to_string(2 * substeps_) +
                         " points a sample, more than there is room for: use fewer substeps");
}

bool PlantStates::Prepare(const DataPack& pack, const StateMemory* before, StateRun* out) const noexcept {
  out->rate = size_ > 0 ? &rate_ : nullptr;
  if (size_ == 0) return true;
  out->start = &start_;
  out->num_states = size_;
  out->num_samples = pack.num_samples;
  out->substeps = substeps_;
  out->h = pack.dt / substeps_;
  out->stride = rate_.num_scalars;
  out->carried = before != nullptr && before->known && !all_measured_;
  const int intervals = pack.num_samples - 1 + (out->carried ? 1 : 0);
  const int points = 2 * substeps_;
  if ((intervals * points + 1) * out->stride > kMaxStateCells) return false;

  PlantSignals from{}, to{}, between{};
  SignalsAt(pack, 0, output_, &to);
  from = out->carried ? before->signals : to;
  bool finite = true;
  for (std::size_t s = 0; s < static_cast<std::size_t>(size_); ++s) {
    const int signal = measured_by_[s];
    out->given[s] = out->carried || signal >= 0;
    out->value[s] = signal >= 0 ? from[static_cast<std::size_t>(signal)] : out->carried ? before->state[s] : 0.0;
    finite = finite && std::isfinite(out->value[s]);
  }
  const double first_t = pack.t_last_s - intervals * pack.dt;
  for (int i = 0; i <= intervals; ++i) {
    const int sample = i + (out->carried ? 0 : 1);  // at the end of the interval
    const bool last = i == intervals;
    if (!last) SignalsAt(pack, sample, output_, &to);
    for (int p = 0; p < (last ? 1 : points); ++p) {
      const double part = static_cast<double>(p) / points;
      for (std::size_t s = 0; s < between.size(); ++s) between[s] = from[s] + part * (to[s] - from[s]);
      features_.Evaluate({between.data(), first_t + (i + part) * pack.dt, pack.dt}, nullptr, out->Row(i * points + p));
    }
    from = to;
  }
  return finite;
}

}  // namespace armcmc
