#include "action.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <utility>

namespace armcmc::ladder {
namespace {

using expression::Graph;
using expression::SymbolKind;

/// Signals, states and time.
std::vector<int> MovingSymbols(const Graph& graph) {
  std::vector<int> symbols;
  for (int node = 0; node < graph.size(); ++node) {
    const expression::GraphNode& at = graph.at(node);
    const bool moves = at.kind == SymbolKind::kSignal || at.kind == SymbolKind::kTime || at.kind == SymbolKind::kState;
    if (at.op == expression::Op::kSymbol && moves) symbols.push_back(node);
  }
  return symbols;
}

bool DependsOnAny(const Graph& graph, int node, const std::vector<int>& symbols) {
  return std::any_of(symbols.begin(), symbols.end(), [&](int symbol) { return graph.DependsOn(node, symbol); });
}

using Reading = std::set<std::pair<SymbolKind, int>>;  ///< Signals, states, time.
using Equations = std::map<std::size_t, Reading>;

/// Quantities on which the derivatives of each equation with respect to the parameters of an effect depend. Empty if
/// the effect has memory.
std::optional<Equations> ActionOf(const Candidate& effect) {
  Graph graph = effect.plant->graph();
  std::vector<int> nodes;
  for (const PlantMode& mode : effect.plant->modes()) nodes.insert(nodes.end(), {mode.when, mode.law});
  for (const PlantState& state : effect.plant->states()) nodes.insert(nodes.end(), {state.start, state.rate});
  const std::vector<int> symbols = MovingSymbols(graph);
  Equations equations;
  for (std::size_t p = 0; p < effect.form().parameters.size(); ++p) {
    const int parameter = graph.Symbol(SymbolKind::kParameter, static_cast<int>(effect.first_parameter + p));
    for (std::size_t e = 0; e < nodes.size(); ++e) {
      if (nodes[e] < 0 || !graph.DependsOn(nodes[e], parameter)) continue;
      const int action = graph.Differentiate(nodes[e], parameter);
      if (action < 0 || graph.at(action).memory) return std::nullopt;
      Reading& reads = equations[e];
      for (const int symbol : symbols)
        if (graph.DependsOn(action, symbol)) reads.emplace(graph.at(symbol).kind, graph.at(symbol).index);
    }
  }
  return equations;
}

}  // namespace

bool Mentions(const EffectForm& form, const std::string& name) {
  const std::regex whole("\\b" + name + "\\b");
  const auto says = [&whole](const std::string& text) { return std::regex_search(text, whole); };
  return std::any_of(form.terms.begin(), form.terms.end(), [&](const EffectTerm& t) { return says(t.formula); }) ||
         std::any_of(form.lets.begin(), form.lets.end(), [&](const LetDescription& l) { return says(l.text); }) ||
         std::any_of(form.states.begin(), form.states.end(), [&](const StateDescription& s) { return says(s.rate); });
}

bool ActOnSameQuantity(const Candidate& a, const Candidate& b) {
  const std::optional<Equations> of_a = ActionOf(a);
  if (!of_a || of_a->empty()) return false;
  const bool one = std::all_of(of_a->begin(), of_a->end(), [](const auto& e) { return e.second.size() == 1; });
  return one && of_a == ActionOf(b);
}

bool IsIndependentOfSignals(const Candidate& effect) {
  const std::optional<Equations> of = ActionOf(effect);
  return of && !of->empty() && std::all_of(of->begin(), of->end(), [](const auto& e) {
           return std::all_of(e.second.begin(), e.second.end(),
                              [](const auto& q) { return q.first == SymbolKind::kTime; });
         });
}

bool Reads(const Candidate& effect, const std::string& name) {
  const EffectForm& form = effect.form();
  if (name == "t") return Mentions(form, name);
  return std::any_of(form.needs.begin(), form.needs.end(), [&](const EffectNeed& need) {
    // A state may be needed only because the effect is added to its rate.
    return need.kind != "parameter" && effect.binding.symbols.at(need.name) == name && Mentions(form, need.name);
  });
}

bool ActsOn(const Candidate& effect, const std::string& slot, const std::string& name) {
  const std::vector<EffectTerm>& terms = effect.form().terms;
  return std::any_of(terms.begin(), terms.end(), [&](const EffectTerm& term) {
    const auto of = effect.binding.symbols.find(term.of);
    return term.slot == slot && of != effect.binding.symbols.end() && of->second == name;
  });
}

bool Remembers(const Candidate& effect) {
  const EffectForm& form = effect.form();
  return !form.states.empty() ||
         std::any_of(expression::kOps.begin(), expression::kOps.end(), [&](const expression::OpInfo& op) {
           return op.memory && op.function && Mentions(form, std::string(op.name));
         });
}

bool Adds(const Candidate& effect) {
  const std::string& slot = effect.form().terms.front().slot;
  return slot == "output" || slot == "rate";
}

bool IsProportionalTo(const Candidate& effect, const std::string& name) {
  const EffectForm& form = effect.form();
  if (form.parameters.size() != 1 || form.terms.front().slot != "output") return false;
  if (Remembers(effect) || !Reads(effect, name)) return false;
  Graph graph = effect.plant->graph();
  const int parameter = graph.Symbol(SymbolKind::kParameter, static_cast<int>(effect.first_parameter));
  const std::vector<int> moving = MovingSymbols(graph);
  for (const PlantMode& mode : effect.plant->modes()) {
    if (mode.law < 0 || !graph.DependsOn(mode.law, parameter)) continue;
    const int action = graph.Differentiate(mode.law, parameter);
    if (action < 0) return false;
    for (const int symbol : moving) {
      if (!graph.DependsOn(action, symbol)) continue;
      const int slope = graph.Differentiate(action, symbol);
      const bool flat = slope >= 0 && graph.IsNumber(slope) && graph.at(slope).value == 0.0;  // it jumps
      if (slope < 0 || flat || DependsOnAny(graph, slope, moving)) return false;
    }
  }
  return true;
}

bool Relaxes(const Candidate& effect) {
  const EffectForm& form = effect.form();
  if (form.states.empty() || !Adds(effect) || !effect.Frequencies().empty()) return false;
  Graph graph = effect.plant->graph();
  const std::vector<int> all = MovingSymbols(graph);
  std::vector<int> own;
  const std::size_t size = effect.plant->states().size(), first = size - form.states.size();
  for (std::size_t s = first; s < size; ++s)
    own.push_back(effect.plant->NodeOf(SymbolKind::kState, static_cast<int>(s)));
  for (std::size_t s = first; s < size; ++s) {
    const int rate = effect.plant->states()[s].rate;
    for (const int symbol : all) {
      if (!graph.DependsOn(rate, symbol)) continue;
      const int slope = graph.Differentiate(rate, symbol);
      const bool its_own = std::find(own.begin(), own.end(), symbol) != own.end();
      if (slope < 0 || DependsOnAny(graph, slope, its_own ? all : own)) return false;
    }
  }
  return true;
}

bool ActsOnLaw(const Candidate& effect) {
  const std::vector<EffectTerm>& terms = effect.form().terms;
  return std::any_of(terms.begin(), terms.end(), [](const EffectTerm& term) { return term.slot == "law"; });
}

}  // namespace armcmc::ladder
