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

Expression::Expression(std::string_view text, const Names& names) : tree_(Parse(text)) { Bind(&tree_, names); }

void Expression::Bind(Tree* node, const Names& names) {
  if (node->kind == Kind::kName) {
    const auto at = std::find(names.begin(), names.end(), node->text);
    if (at == names.end())
      throw Error(node->column, "nothing is called \"" + node->text + "\" here; there are " + Listed(names));
    node->slot = static_cast<int>(at - names.begin());
  }
  if (HasMemory(*node)) {
    node->slot = static_cast<int>(memories_.size());
    memories_.emplace_back();
  }
  for (Tree& argument : node->arguments) Bind(&argument, names);
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
    return memory.last_result + part * (memory.result - memory.last_result);
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
    if (!first) memory.y += dt * (a + e) / 2.0;
    return memory.y;
  }
  if (node.text == "delay") {
    memory.t.push_back(memory.elapsed);
    memory.e.push_back(e);
    return Between(memory.t, memory.e, memory.elapsed - tau);
  }
  if (first || !(tau > 0.0)) return memory.y = e;
  const double decay = std::exp(-dt / tau);
  const double mean = -std::expm1(-dt / tau) * tau / dt;
  memory.y = memory.y * decay + a * (mean - decay) + e * (1.0 - mean);
  return memory.y;
}

}  // namespace armcmc::plant_sim::expression
