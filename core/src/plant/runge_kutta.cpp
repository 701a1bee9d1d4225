#include "plant/runge_kutta.hpp"

#include <algorithm>

namespace armcmc {
namespace {

using expression::Graph;
using expression::GraphNode;
using expression::Op;
using expression::SymbolKind;

constexpr std::size_t kMaxCoefficients = 64;  // they stay in registers from sample to sample

std::vector<int> InputsOf(const Graph& graph, const std::vector<int>& nodes) {
  std::vector<int> inputs;
  std::vector<bool> seen(static_cast<std::size_t>(graph.size()), false);
  std::vector<int> open = nodes;
  while (!open.empty()) {
    const int node = open.back();
    open.pop_back();
    if (node < 0 || seen[static_cast<std::size_t>(node)]) continue;
    seen[static_cast<std::size_t>(node)] = true;
    const GraphNode& at = graph.at(node);
    if (at.sampled) {
      open.insert(open.end(), at.argument.begin(), at.argument.end());
    } else if (at.varies) {
      inputs.push_back(node);
    }
  }
  return inputs;
}

}  // namespace

RungeKutta::RungeKutta(Graph* graph, std::vector<int> rates)
    : graph_(*graph),
      rates_(std::move(rates)),
      inputs_(InputsOf(*graph, rates_)),
      h_(graph->Symbol(SymbolKind::kConstant, 0)),
      half_(Times(graph->Number(0.5), h_)),
      third_(Times(graph->Number(1.0 / 3.0), h_)),
      sixth_(Times(graph->Number(1.0 / 6.0), h_)) {
  for (std::size_t s = 0; s < rates_.size(); ++s)
    states_.push_back(graph_.Symbol(SymbolKind::kState, static_cast<int>(s)));
}

int RungeKutta::Given(int point, std::size_t input) {
  return graph_.Symbol(SymbolKind::kGiven, 1 + point * static_cast<int>(inputs_.size()) + static_cast<int>(input));
}

int RungeKutta::At(int node, const std::vector<int>& states, int point) {
  std::map<int, int> by;
  for (std::size_t s = 0; s < states_.size(); ++s) by.emplace(states_[s], states[s]);
  for (std::size_t i = 0; i < inputs_.size(); ++i) by.emplace(inputs_[i], Given(point, i));
  return graph_.Substitute(node, by);
}

std::vector<int> RungeKutta::Rates(const std::vector<int>& states, int point) {
  std::vector<int> rates;
  for (const int rate : rates_) rates.push_back(At(rate, states, point));
  return rates;
}

void RungeKutta::MakeExact(const std::vector<RememberedState>& remembered, std::vector<int>* results) {
  if (remembered.empty()) return;
  const auto minus = [this](int a, int b) { return graph_.Make(Op::kSubtract, a, b); };
  const auto over = [this](int a, int b) { return graph_.Make(Op::kDivide, a, b); };
  for (const RememberedState& one : remembered) {
    if (one.late >= 0) continue;
    const auto s = static_cast<std::size_t>(one.state);
    const int a = At(one.argument, states_, 0);
    const int b = At(one.argument, *results, 2);
    if (one.tau < 0) {
      (*results)[s] = Plus(states_[s], Times(half_, Plus(a, b)));
      continue;
    }
    const int ratio = over(h_, At(one.tau, states_, 0));
    const int decay = graph_.Make(Op::kExp, graph_.Make(Op::kNegate, ratio));
    const int mean = over(minus(graph_.Number(1.0), decay), ratio);
    (*results)[s] = minus(Plus(b, Times(decay, minus(states_[s], a))), Times(mean, minus(b, a)));
  }
  std::erase_if(stages_, [&](int stage) {
    return std::none_of(results->begin(), results->end(), [&](int r) { return graph_.DependsOn(r, stage); });
  });
}

std::vector<int> RungeKutta::Moved(const std::vector<int>& rates, int h) {
  std::vector<int> moved;
  for (std::size_t s = 0; s < states_.size(); ++s) moved.push_back(Plus(states_[s], Times(h, rates[s])));
  return moved;
}

std::vector<int> RungeKutta::Staged() {
  const std::vector<int> k1 = Rates(states_, 0);
  const std::vector<int> k2 = Rates(Moved(k1, half_), 1);
  const std::vector<int> k3 = Rates(Moved(k2, half_), 1);
  const std::vector<int> k4 = Rates(Moved(k3, h_), 2);
  std::vector<int> results;
  for (std::size_t s = 0; s < states_.size(); ++s)
    results.push_back(Plus(states_[s], Plus(Times(sixth_, Plus(k1[s], k4[s])), Times(third_, Plus(k2[s], k3[s])))));
  stages_.clear();
  for (const std::vector<int>* k : {&k1, &k2, &k3, &k4}) stages_.insert(stages_.end(), k->begin(), k->end());
  return results;
}

std::optional<RungeKutta::Form> RungeKutta::FormOf(int node) {  // NOLINT(misc-no-recursion): as deep as the graph
  if (const auto known = forms_.find(node); known != forms_.end()) return known->second;
  return forms_[node] = MakeForm(node);
}

std::optional<RungeKutta::Form> RungeKutta::MakeForm(int node) {  // NOLINT(misc-no-recursion): see FormOf
  const auto is = [node](const std::vector<int>& symbols) {
    return std::find(symbols.begin(), symbols.end(), node) != symbols.end();
  };
  if (is(states_) || is(inputs_)) return Form{{{node, graph_.Number(1.0)}}, graph_.Number(0.0)};
  const GraphNode n = graph_.at(node);
  if (!n.varies) return Form{{}, node};
  const bool two = n.op == Op::kAdd || n.op == Op::kSubtract || n.op == Op::kMultiply || n.op == Op::kDivide;
  if (!two && n.op != Op::kNegate) return std::nullopt;
  const std::optional<Form> a = FormOf(n.argument[0]);
  if (!a) return std::nullopt;
  const int minus_one = graph_.Number(-1.0);
  if (n.op == Op::kNegate) return Times(*a, minus_one);
  const std::optional<Form> b = FormOf(n.argument[1]);
  if (!b) return std::nullopt;
  switch (n.op) {
    case Op::kAdd: return Plus(*a, *b);
    case Op::kSubtract: return Plus(*a, Times(*b, minus_one));
    case Op::kMultiply:
      if (a->coefficient.empty()) return Times(*b, a->constant);
      return b->coefficient.empty() ? std::optional(Times(*a, b->constant)) : std::nullopt;
    default:
      if (!b->coefficient.empty()) return std::nullopt;
      return Times(*a, graph_.Make(Op::kDivide, graph_.Number(1.0), b->constant));
  }
}

RungeKutta::Form RungeKutta::Plus(Form a, const Form& b) {
  a.constant = Plus(a.constant, b.constant);
  for (const auto& [symbol, factor] : b.coefficient) {
    const auto [at, is_new] = a.coefficient.try_emplace(symbol, factor);
    if (!is_new) at->second = Plus(at->second, factor);
  }
  return a;
}

RungeKutta::Form RungeKutta::Times(Form a, int factor) {
  a.constant = Times(a.constant, factor);
  for (auto& [symbol, own] : a.coefficient) own = Times(own, factor);
  std::erase_if(a.coefficient, [&](const auto& term) { return graph_.IsNumber(term.second, 0.0); });
  return a;
}

std::vector<RungeKutta::Form> RungeKutta::Rates(const std::vector<Form>& rates, const std::vector<Form>& states,
                                                int point) {
  std::vector<Form> at;
  for (const Form& rate : rates) {
    Form sum{{}, rate.constant};
    for (const auto& [symbol, factor] : rate.coefficient) {
      const auto state = std::find(states_.begin(), states_.end(), symbol);
      if (state != states_.end()) {
        sum = Plus(std::move(sum), Times(states[static_cast<std::size_t>(state - states_.begin())], factor));
        continue;
      }
      const auto input = std::find(inputs_.begin(), inputs_.end(), symbol) - inputs_.begin();
      sum = Plus(std::move(sum), Form{{{Given(point, static_cast<std::size_t>(input)), factor}}, graph_.Number(0.0)});
    }
    at.push_back(std::move(sum));
  }
  return at;
}

std::vector<RungeKutta::Form> RungeKutta::Moved(const std::vector<Form>& states, const std::vector<Form>& rates,
                                                int h) {
  std::vector<Form> moved;
  for (std::size_t s = 0; s < states.size(); ++s) moved.push_back(Plus(states[s], Times(rates[s], h)));
  return moved;
}

int RungeKutta::NodeOf(const Form& form) {
  int node = form.constant;
  for (const auto& [symbol, factor] : form.coefficient) node = Plus(node, Times(symbol, factor));
  return node;
}

std::vector<int> RungeKutta::Linear() {
  if (states_.size() * (states_.size() + 3 * inputs_.size()) > kMaxCoefficients) return {};
  std::vector<Form> rates, states;
  for (const int rate : rates_) {
    const std::optional<Form> form = FormOf(rate);
    if (!form) return {};
    rates.push_back(*form);
  }
  for (const int state : states_) states.push_back(*FormOf(state));
  const std::vector<Form> k1 = Rates(rates, states, 0);
  const std::vector<Form> k2 = Rates(rates, Moved(states, k1, half_), 1);
  const std::vector<Form> k3 = Rates(rates, Moved(states, k2, half_), 1);
  const std::vector<Form> k4 = Rates(rates, Moved(states, k3, h_), 2);
  std::vector<int> results;
  for (std::size_t s = 0; s < states.size(); ++s)
    results.push_back(
        NodeOf(Plus(states[s], Plus(Times(Plus(k1[s], k4[s]), sixth_), Times(Plus(k2[s], k3[s]), third_)))));
  return results;
}

}  // namespace armcmc
