#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/expression/features.hpp"
#include "armcmc/plant/held.hpp"
#include "armcmc/plant/plant.hpp"

namespace armcmc::test {

/// A described plant with numbers for its parameters, over a whole recording: states by Runge-Kutta, inputs linear
/// or held between samples, functions with memory from sample to sample. Slow and plain: what composed plants are
/// compared by.
class PlantRun {
 public:
  PlantRun(const Plant& plant, const std::map<std::string, double>& values) : plant_(plant), graph_(plant.graph()) {
    const PlantDescription& description = plant.description();
    num_signals_ = static_cast<int>(description.signals.size());
    for (std::size_t p = 0; p < description.parameters.size(); ++p)
      fixed_[Node(expression::SymbolKind::kParameter, p)] = graph_.Number(values.at(description.parameters[p].name));
    for (std::size_t s = 0; s < plant.states().size(); ++s)
      fixed_[Node(expression::SymbolKind::kState, s)] =
          graph_.Symbol(expression::SymbolKind::kSignal, num_signals_ + int(s));
  }

  /// What is predicted of the output. @param columns  [signal][sample].
  std::vector<double> Output(const std::vector<std::vector<double>>& columns, double dt) {
    return Run(columns, dt, plant_.predicts() >= 0 ? graph_.Substitute(plant_.predicts(), fixed_) : Law());
  }

  /// What the law of the mode that acts says: of the output, or of what the mode explains instead.
  std::vector<double> Explained(const std::vector<std::vector<double>>& columns, double dt) {
    return Run(columns, dt, Law());
  }

 private:
  std::vector<double> Run(const std::vector<std::vector<double>>& columns, double dt, int shown) {
    const std::size_t num_states = plant_.states().size();
    std::vector<int> rates, starts;
    for (const PlantState& state : plant_.states()) {
      rates.push_back(graph_.Substitute(state.rate, fixed_));
      starts.push_back(graph_.Substitute(state.start, fixed_));
    }
    // Memory in rates is of signals alone: its values at the samples are further inputs.
    std::map<int, int> remembered;
    std::vector<int> memories;
    for (int n = 0; n < graph_.size(); ++n)
      if (InfoOf(graph_.at(n).op).memory &&
          std::any_of(rates.begin(), rates.end(), [&](int rate) { return graph_.DependsOn(rate, n); }))
        memories.push_back(n);
    held_ = HeldSignals(plant_.description());
    HeldNodes held(&graph_, held_);
    held_.resize(held_.size() + num_states, false);
    for (const int memory : memories) held_.push_back(held.Is(memory));
    const expression::FeatureProgram memory_program(graph_, memories);
    for (std::size_t m = 0; m < memories.size(); ++m)
      remembered[memories[m]] = graph_.Symbol(expression::SymbolKind::kSignal, num_signals_ + int(num_states) + int(m));
    for (int& rate : rates) rate = graph_.Substitute(rate, remembered);
    const expression::FeatureProgram rate_program(graph_, rates), start_program(graph_, starts),
        law_program(graph_, {shown});

    const std::size_t rows = columns.front().size();
    std::vector<std::vector<double>> inputs(rows);
    expression::FeatureMemory memory, law_memory, start_memory;
    for (std::size_t n = 0; n < rows; ++n) {
      for (const auto& column : columns) inputs[n].push_back(column[n]);
      inputs[n].resize(columns.size() + num_states + memories.size());
      std::vector<double> at(memories.size());
      memory_program.Evaluate({inputs[n].data(), double(n) * dt, dt}, &memory, at.data());
      std::copy(at.begin(), at.end(), inputs[n].end() - std::ptrdiff_t(memories.size()));
    }
    std::vector<double> state(num_states), output(rows);
    start_program.Evaluate({inputs[0].data(), 0.0, dt}, &start_memory, state.data());
    for (std::size_t n = 0; n < rows; ++n) {
      std::vector<double> now = inputs[n];
      std::copy(state.begin(), state.end(), now.begin() + num_signals_);
      law_program.Evaluate({now.data(), double(n) * dt, dt}, &law_memory, &output[n]);
      if (n + 1 < rows) Step(rate_program, inputs[n], inputs[n + 1], double(n) * dt, dt, &state);
    }
    return output;
  }

  int Node(expression::SymbolKind kind, std::size_t index) { return graph_.Symbol(kind, static_cast<int>(index)); }

  int Law() {
    int law = graph_.Number(0.0);
    for (std::size_t m = plant_.modes().size(); m-- > 0;) {
      const PlantMode& mode = plant_.modes()[m];
      const int own = graph_.Substitute(mode.law, fixed_);
      law = mode.when < 0 ? own : graph_.Make(expression::Op::kIf, graph_.Substitute(mode.when, fixed_), own, law);
    }
    return law;
  }

  void Step(const expression::FeatureProgram& rates, const std::vector<double>& from, const std::vector<double>& to,
            double t, double dt, std::vector<double>* state) const {
    int substeps = 1;
    for (const StateDescription& s : plant_.description().states) substeps = std::max(substeps, s.substeps);
    const double h = dt / substeps;
    const auto rate = [&](double part, const std::vector<double>& x) {
      std::vector<double> now(from.size()), dx(x.size());
      for (std::size_t i = 0; i < from.size(); ++i) now[i] = from[i] + (held_[i] ? 0.0 : part) * (to[i] - from[i]);
      std::copy(x.begin(), x.end(), now.begin() + num_signals_);
      rates.Evaluate({now.data(), t + part * dt, dt}, nullptr, dx.data());
      return dx;
    };
    const auto moved = [&](const std::vector<double>& k, double step) {
      std::vector<double> x = *state;
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += step * k[i];
      return x;
    };
    for (int j = 0; j < substeps; ++j) {
      const double begin = double(j) / substeps, middle = (j + 0.5) / substeps, end = (j + 1.0) / substeps;
      const auto k1 = rate(begin, *state), k2 = rate(middle, moved(k1, 0.5 * h)), k3 = rate(middle, moved(k2, 0.5 * h)),
                 k4 = rate(end, moved(k3, h));
      for (std::size_t i = 0; i < state->size(); ++i)
        (*state)[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
    }
  }

  const Plant& plant_;
  expression::Graph graph_;
  std::map<int, int> fixed_;
  int num_signals_ = 0;
  std::vector<bool> held_;  ///< Of the inputs.
};

}  // namespace armcmc::test
