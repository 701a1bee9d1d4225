#include "armcmc/plant_sim/expression/jet.hpp"

#include <cmath>
#include <cstddef>

#include "armcmc/plant_sim/expression/expression.hpp"

namespace armcmc::plant_sim::expression {
namespace {

Jet Plus(const Jet& a, const Jet& b, double sign) {
  return {a[0] + sign * b[0], a[1] + sign * b[1], a[2] + sign * b[2], a[3] + sign * b[3]};
}

Jet Times(const Jet& a, const Jet& b) {
  return {a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2],
          a[3] * b[0] + 3.0 * a[2] * b[1] + 3.0 * a[1] * b[2] + a[0] * b[3]};
}

bool IsConstant(const Jet& u) { return u[1] == 0.0 && u[2] == 0.0 && u[3] == 0.0; }

/// x^p and its derivatives, p constant: a factor that is 0 ends the chain before 0^-1 can be asked for.
Jet PowerOf(double x, double p) {
  Jet f{};
  double factor = 1.0;
  for (std::size_t k = 0; k < f.size() && factor != 0.0; ++k) {
    f[k] = factor * std::pow(x, p - static_cast<double>(k));
    factor *= p - static_cast<double>(k);
  }
  return f;
}

Jet LogOf(double x) { return {std::log(x), 1.0 / x, -1.0 / (x * x), 2.0 / (x * x * x)}; }

Jet Scaled(Jet f, double scale) {
  for (double& d : f) d *= scale;
  return f;
}

/// A smooth function of one argument and its derivatives there; false where there is none of that name.
bool Smooth(const std::string& name, double x, Jet* f) {
  const double s = std::sin(x), c = std::cos(x);
  if (name == "sqrt") {
    *f = PowerOf(x, 0.5);
  } else if (name == "exp") {
    *f = Scaled({1.0, 1.0, 1.0, 1.0}, std::exp(x));
  } else if (name == "log") {
    *f = LogOf(x);
  } else if (name == "log2") {
    *f = Scaled(LogOf(x), 1.0 / std::log(2.0));
  } else if (name == "log10") {
    *f = Scaled(LogOf(x), 1.0 / std::log(10.0));
  } else if (name == "sin") {
    *f = {s, c, -s, -c};
  } else if (name == "cos") {
    *f = {c, -s, -c, s};
  } else if (name == "tan") {
    const double t = std::tan(x), g = 1.0 + t * t;
    *f = {t, g, 2.0 * t * g, 2.0 * g * (1.0 + 3.0 * t * t)};
  } else if (name == "tanh") {
    const double t = std::tanh(x), g = 1.0 - t * t;
    *f = {t, g, -2.0 * t * g, 2.0 * g * (3.0 * t * t - 1.0)};
  } else if (name == "atan") {
    const double g = 1.0 / (1.0 + x * x);
    *f = {std::atan(x), g, -2.0 * x * g * g, (6.0 * x * x - 2.0) * g * g * g};
  } else if (name == "asin" || name == "acos") {
    const double g = 1.0 / std::sqrt(1.0 - x * x), sign = name == "asin" ? 1.0 : -1.0;
    *f = Scaled({0.0, g, x * g * g * g, (1.0 + 2.0 * x * x) * std::pow(g, 5.0)}, sign);
    (*f)[0] = name == "asin" ? std::asin(x) : std::acos(x);
  } else {
    return false;
  }
  return true;
}

Jet Power(const Jet& a, const Jet& b) {
  if (IsConstant(b)) return Compose(PowerOf(a[0], b[0]), a);
  const Jet exponent = Times(b, Compose(LogOf(a[0]), a));
  const double value = std::exp(exponent[0]);
  return Compose({value, value, value, value}, exponent);
}

Jet Branch(const std::string& what, const Jet& a, const Jet& b, const Jet& c) {
  if (what == "abs") return a[0] < 0.0 ? Plus({}, a, -1.0) : a;
  if (what == "min") return b[0] < a[0] ? b : a;
  if (what == "max") return a[0] < b[0] ? b : a;
  if (what == "clamp") return a[0] < b[0] ? b : (a[0] > c[0] ? c : a);
  if (what == "if") return a[0] != 0.0 ? b : c;
  return {Apply(what, a[0], b[0], c[0]), 0.0, 0.0, 0.0};  // what only has steps
}

}  // namespace

Jet Compose(const Jet& f, const Jet& u) {
  return {f[0], f[1] * u[1], f[2] * u[1] * u[1] + f[1] * u[2],
          f[3] * u[1] * u[1] * u[1] + 3.0 * f[2] * u[1] * u[2] + f[1] * u[3]};
}

Jet Differentiate(const Tree& node, const std::vector<double>& values, int time) {
  if (node.kind == Kind::kNumber) return {node.number, 0.0, 0.0, 0.0};
  if (node.kind == Kind::kName)
    return {values[static_cast<std::size_t>(node.slot)], node.slot == time ? 1.0 : 0.0, 0.0, 0.0};
  if (HasMemory(node)) throw Error(node.column, node.text + " has a memory, and an input is a function of time alone");
  std::array<Jet, 3> u{};
  for (std::size_t i = 0; i < node.arguments.size(); ++i) u[i] = Differentiate(node.arguments[i], values, time);
  if (node.text == "+") return Plus(u[0], u[1], 1.0);
  if (node.text == "-") return Plus(u[0], u[1], -1.0);
  if (node.text == "neg") return Plus({}, u[0], -1.0);
  if (node.text == "*") return Times(u[0], u[1]);
  if (node.text == "/") return Times(u[0], Compose(PowerOf(u[1][0], -1.0), u[1]));
  if (node.text == "^") return Power(u[0], u[1]);
  Jet f{};
  if (Smooth(node.text, u[0][0], &f)) return Compose(f, u[0]);
  return Branch(node.text, u[0], u[1], u[2]);
}

}  // namespace armcmc::plant_sim::expression
