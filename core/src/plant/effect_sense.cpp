#include "effect_sense.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "armcmc/expression/syntax.hpp"
#include "effect_reading.hpp"

namespace armcmc {
namespace {

using expression::Op;
using expression::Syntax;
using expression::SyntaxNode;

int SignOf(double value) { return value > 0.0 ? 1 : value < 0.0 ? -1 : 0; }

int SignOfParameter(const ParameterDescription& p) {
  if (p.lower && *p.lower >= 0.0) return 1;
  if (p.upper && *p.upper <= 0.0) return -1;
  return p.prior == "uniform" ? 0 : SignOf(p.mean);
}

/// What is known of a subexpression: its sign, and whether it rises (1) or falls (-1) with a signal. 0: not known.
struct Trend {
  int sign = 0;
  int slope = 0;
  bool reads = false;  ///< It depends on the signal.
};

Trend Opposite(const Trend& x) { return {-x.sign, -x.slope, x.reads}; }

Trend Sum(const Trend& a, const Trend& b) {
  Trend sum{a.sign == b.sign ? a.sign : 0, 0, a.reads || b.reads};
  if (a.reads != b.reads)
    sum.slope = a.reads ? a.slope : b.slope;
  else if (a.slope == b.slope)
    sum.slope = a.slope;
  return sum;
}

Trend Product(const Trend& a, const Trend& b) {
  Trend product{a.sign * b.sign, 0, a.reads || b.reads};
  if (a.reads != b.reads) product.slope = a.reads ? a.slope * b.sign : b.slope * a.sign;
  return product;
}

/// a / b, where 1 / b has the sign of b.
Trend Quotient(const Trend& a, const Trend& b) {
  return {a.sign * b.sign, b.reads ? 0 : a.slope * b.sign, a.reads || b.reads};
}

Trend Power(const Trend& base, const Trend& exponent, const SyntaxNode& number) {
  const bool whole = number.op == Op::kNumber && std::floor(number.value) == number.value;
  const bool odd = whole && std::fmod(number.value, 2.0) != 0.0;
  Trend power{whole && odd ? base.sign : 1, 0, base.reads || exponent.reads};
  if (odd && number.value > 0.0) power.slope = base.slope;
  return power;
}

class TrendReader {
 public:
  TrendReader(const PlantDescription& plant, const std::string& signal, const Syntax& syntax)
      : plant_(plant), signal_(signal), syntax_(syntax) {}

  [[nodiscard]] Trend Node(int node) const {  // NOLINT(misc-no-recursion): as deep as the text, which is bounded
    const SyntaxNode& at = syntax_.at(node);
    const auto argument = [&](std::size_t i) { return Node(at.argument[i]); };
    switch (at.op) {
      case Op::kNumber: return {SignOf(at.value), 0, false};
      case Op::kSymbol: return {SignOfSymbol(at.name), at.name == signal_ ? 1 : 0, at.name == signal_};
      case Op::kNegate: return Opposite(argument(0));
      case Op::kAdd: return Sum(argument(0), argument(1));
      case Op::kSubtract: return Sum(argument(0), Opposite(argument(1)));
      case Op::kMultiply: return Product(argument(0), argument(1));
      case Op::kDivide: return Quotient(argument(0), argument(1));
      case Op::kPower: return Power(argument(0), argument(1), syntax_.at(at.argument[1]));
      case Op::kIf: return Sum(argument(1), argument(2));
      case Op::kMin:
      case Op::kMax: return Sum(argument(0), argument(1));
      case Op::kSign:
      case Op::kTanh:
      case Op::kAtan:
      case Op::kAsin:
      case Op::kClamp:
      case Op::kLowpass:
      case Op::kDelay:
      case Op::kPrevious: return argument(0);
      case Op::kSqrt:
      case Op::kExp: return {1, argument(0).slope, argument(0).reads};
      default: return Unknown(at);
    }
  }

 private:
  [[nodiscard]] Trend Unknown(const SyntaxNode& at) const {  // NOLINT(misc-no-recursion): see Node
    Trend unknown{at.op == Op::kAbs ? 1 : 0, 0, false};
    for (const int argument : at.argument) unknown.reads = unknown.reads || (argument >= 0 && Node(argument).reads);
    return unknown;
  }

  [[nodiscard]] int SignOfSymbol(const std::string& name) const {
    for (const ParameterDescription& p : plant_.parameters)
      if (p.name == name) return SignOfParameter(p);
    for (const ConstantDescription& c : plant_.constants)
      if (c.name == name) return SignOf(c.value);
    return 0;
  }

  const PlantDescription& plant_;
  const std::string& signal_;
  const Syntax& syntax_;
};

/// The texts that explain the output.
std::vector<std::string> Laws(const PlantDescription& plant) {
  if (!plant.predicts.empty()) return {plant.predicts};
  if (!plant.law.empty()) return {plant.law};
  std::vector<std::string> laws;
  for (const ModeDescription& mode : plant.modes)
    if (!mode.law.empty()) laws.push_back(mode.law);
  return laws;
}

/// 1 where all laws that read the signal rise with it, -1 where all fall, 0 otherwise.
int SignOfSlopeIn(const PlantDescription& plant, const std::string& signal) {
  int slope = 0;
  for (const std::string& law : Laws(plant)) {
    const Syntax syntax = expression::Parse(WithoutLets(plant, law));
    const Trend trend = TrendReader(plant, signal, syntax).Node(syntax.root());
    if (!trend.reads) continue;
    if (trend.slope == 0 || trend.slope == -slope) return 0;
    slope = trend.slope;
  }
  return slope;
}

}  // namespace

int SenseOfResistance(const PlantDescription& plant) {
  const PlantDescription written = AsWritten(plant);
  for (const char* role : {"acceleration", "velocity", "position"})
    for (const SignalDescription& signal : written.signals) {
      if (signal.role != role || signal.name == written.output) continue;
      const int slope = SignOfSlopeIn(written, signal.name);
      if (slope != 0) return slope;
    }
  return 1;
}

}  // namespace armcmc
