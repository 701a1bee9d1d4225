#include "armcmc/plant_sim/expression/expression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <utility>

namespace armcmc::plant_sim::expression {
namespace {

using Three = double (*)(double, double, double);

double Clamped(double x, double lower, double upper) { return std::min(std::max(x, lower), upper); }
double SignOf(double x) { return x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : x); }

const std::map<std::string, Three, std::less<>>& Table() {
  static const std::map<std::string, Three, std::less<>> table = {
      {"+", [](double a, double b, double) { return a + b; }},
      {"-", [](double a, double b, double) { return a - b; }},
      {"*", [](double a, double b, double) { return a * b; }},
      {"/", [](double a, double b, double) { return a / b; }},
      {"^", [](double a, double b, double) { return std::pow(a, b); }},
      {"neg", [](double a, double, double) { return -a; }},
      {"<", [](double a, double b, double) { return a < b ? 1.0 : 0.0; }},
      {"<=", [](double a, double b, double) { return a <= b ? 1.0 : 0.0; }},
      {">", [](double a, double b, double) { return a > b ? 1.0 : 0.0; }},
      {">=", [](double a, double b, double) { return a >= b ? 1.0 : 0.0; }},
      {"==", [](double a, double b, double) { return a == b ? 1.0 : 0.0; }},
      {"!=", [](double a, double b, double) { return a != b ? 1.0 : 0.0; }},
      {"and", [](double a, double b, double) { return a != 0.0 && b != 0.0 ? 1.0 : 0.0; }},
      {"or", [](double a, double b, double) { return a != 0.0 || b != 0.0 ? 1.0 : 0.0; }},
      {"not", [](double a, double, double) { return a == 0.0 ? 1.0 : 0.0; }},
      {"abs", [](double a, double, double) { return std::abs(a); }},
      {"sign", [](double a, double, double) { return SignOf(a); }},
      {"sqrt", [](double a, double, double) { return std::sqrt(a); }},
      {"exp", [](double a, double, double) { return std::exp(a); }},
      {"log", [](double a, double, double) { return std::log(a); }},
      {"log2", [](double a, double, double) { return std::log2(a); }},
      {"log10", [](double a, double, double) { return std::log10(a); }},
      {"sin", [](double a, double, double) { return std::sin(a); }},
      {"cos", [](double a, double, double) { return std::cos(a); }},
      {"tan", [](double a, double, double) { return std::tan(a); }},
      {"asin", [](double a, double, double) { return std::asin(a); }},
      {"acos", [](double a, double, double) { return std::acos(a); }},
      {"atan", [](double a, double, double) { return std::atan(a); }},
      {"tanh", [](double a, double, double) { return std::tanh(a); }},
      {"min", [](double a, double b, double) { return b < a ? b : a; }},
      {"max", [](double a, double b, double) { return a < b ? b : a; }},
      {"clamp", Clamped},
      {"step", [](double a, double, double) { return a >= 0.0 ? 1.0 : 0.0; }},
      {"if", [](double a, double b, double c) { return a != 0.0 ? b : c; }}};
  return table;
}

std::string Listed(const Names& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Value at a time of a line through samples; before it that of the first one, after it that of the last.
double Between(const std::vector<double>& t, const std::vector<double>& e, double at) {
  const auto after = std::upper_bound(t.begin(), t.end(), at);
  if (after == t.begin()) return e.front();
  const auto i = static_cast<std::size_t>(after - t.begin());
  if (i == t.size()) return e.back();
  return e[i - 1] + (at - t[i - 1]) / (t[i] - t[i - 1]) * (e[i] - e[i - 1]);
}

/// The value at a time of what is held from sample to sample.
double HeldAt(const std::vector<double>& t, const std::vector<double>& e, double at) {
  constexpr double kRounding = 1e-6;  // of an interval: a whole number of them that was computed is one
  const double interval = t.size() > 1 ? t[1] - t[0] : 0.0;
  const auto after = std::upper_bound(t.begin(), t.end(), at + kRounding * interval);
  return after == t.begin() ? e.front() : e[static_cast<std::size_t>(after - t.begin()) - 1];
}

void MarkHeld(Tree* node, const Names& names, const std::vector<bool>& held) {
  for (Tree& argument : node->arguments) MarkHeld(&argument, names, held);
  const auto is_held = [](const Tree& argument) { return argument.held; };
  const auto place = static_cast<std::size_t>(std::find(names.begin(), names.end(), node->text) - names.begin());
  if (node->kind == Kind::kNumber)
    node->held = true;
  else if (node->kind == Kind::kName)
    node->held = place < held.size() && held[place];
  else if (HasMemory(*node))
    node->held = (node->text == "delay" || node->text == "previous") && node->arguments[0].held;
  else
    node->held = std::all_of(node->arguments.begin(), node->arguments.end(), is_held);
}

bool ReadsPlace(const Tree& node, int place) {
  if (node.kind == Kind::kName) return node.slot == place;
  return std::any_of(node.arguments.begin(), node.arguments.end(),
                     [place](const Tree& argument) { return ReadsPlace(argument, place); });
}

bool RemembersPlaceIn(const Tree& node, int place) {
  const bool here = HasMemory(node);
  return std::any_of(node.arguments.begin(), node.arguments.end(), [&](const Tree& argument) {
    return here ? ReadsPlace(argument, place) : RemembersPlaceIn(argument, place);
  });
}

}  // namespace

double Apply(const std::string& what, double a, double b, double c) { return Table().at(what)(a, b, c); }

Expression::Expression(std::string_view text, const Names& names, const std::vector<bool>& held, bool is_rate)
    : tree_(Parse(text)) {
  MarkHeld(&tree_, names, held);
  Bind(&tree_, names, held, is_rate);
}

void Expression::Bind(Tree* node, const Names& names, const std::vector<bool>& held, bool integrated) {
  if (node->kind == Kind::kName) {
    const auto at = std::find(names.begin(), names.end(), node->text);
    if (at == names.end())
      throw Error(node->column, "unknown name \"" + node->text + "\"; known here: " + Listed(names));
    node->slot = static_cast<int>(at - names.begin());
  }
  if (HasMemory(*node)) {
    node->slot = static_cast<int>(memories_.size());
    memories_.emplace_back();
  }
  const bool integrates = node->text == "lowpass" || node->text == "integral";
  node->takes_held =
      HasMemory(*node) && !node->arguments.empty() && node->arguments[0].held && (integrates || !integrated);
  for (Tree& argument : node->arguments) Bind(&argument, names, held, integrated || (integrates && node->takes_held));
}

bool Expression::Reads(int place) const { return ReadsPlace(tree_, place); }

bool Expression::RemembersPlace(int place) const { return RemembersPlaceIn(tree_, place); }

double Expression::EvaluateBetween(const std::vector<double>& values, double part) {
  return WalkBetween(tree_, values, part);
}

double Expression::WalkBetween(const Tree& node, const std::vector<double>& values, double part) const {
  if (node.kind == Kind::kNumber) return node.number;
  if (node.kind == Kind::kName) return values[static_cast<std::size_t>(node.slot)];
  if (HasMemory(node)) {
    const Memory& memory = memories_[static_cast<std::size_t>(node.slot)];
    return memory.last_result + (node.held ? 0.0 : part) * (memory.result - memory.last_result);
  }
  std::array<double, 3> argument{};
  for (std::size_t i = 0; i < node.arguments.size(); ++i) argument[i] = WalkBetween(node.arguments[i], values, part);
  return Apply(node.text, argument[0], argument[1], argument[2]);
}

double Expression::Evaluate(const std::vector<double>& values, double dt) { return Walk(tree_, values, dt); }

double Expression::Walk(const Tree& node, const std::vector<double>& values, double dt) {
  if (node.kind == Kind::kNumber) return node.number;
  if (node.kind == Kind::kName) return values[static_cast<std::size_t>(node.slot)];
  std::array<double, 3> argument{};
  for (std::size_t i = 0; i < node.arguments.size(); ++i) argument[i] = Walk(node.arguments[i], values, dt);
  if (HasMemory(node)) {
    const double result = Remember(node, argument[0], argument[1], dt);
    Memory& memory = memories_[static_cast<std::size_t>(node.slot)];
    memory.last_result = std::exchange(memory.result, result);
    return result;
  }
  return Apply(node.text, argument[0], argument[1], argument[2]);
}

double Expression::Remember(const Tree& node, double e, double tau, double dt) {
  Memory& memory = memories_[static_cast<std::size_t>(node.slot)];
  const bool first = !memory.started;
  const double a = first ? e : memory.before;
  if (!first) memory.elapsed += dt;
  memory.started = true;
  memory.before = e;
  if (node.text == "elapsed") return memory.elapsed;
  if (node.text == "previous") return a;
  if (node.text == "integral") {
    if (!first) memory.y += dt * (node.takes_held ? a : (a + e) / 2.0);
    return memory.y;
  }
  if (node.text == "delay") {
    memory.t.push_back(memory.elapsed);
    memory.e.push_back(e);
    return node.takes_held ? HeldAt(memory.t, memory.e, memory.elapsed - tau)
                           : Between(memory.t, memory.e, memory.elapsed - tau);
  }
  if (first || !(tau > 0.0)) return memory.y = e;
  const double decay = std::exp(-dt / tau);
  const double mean = -std::expm1(-dt / tau) * tau / dt;
  memory.y =
      node.takes_held ? memory.y * decay + a * (1.0 - decay) : memory.y * decay + a * (mean - decay) + e * (1.0 - mean);
  return memory.y;
}

}  // namespace armcmc::plant_sim::expression
