#include "armcmc/expression/compile.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>

#include "expression/virtual_code.hpp"

namespace armcmc::expression {
namespace {

/// factor x register, or factor x register x other.
struct Term {
  int factor = -1;  ///< Node.
  int reg = -1;
  int other = -1;
};

/// constant + sum of the terms: a value that is not yet computed.
struct Linear {
  int constant = -1;  ///< Node.
  std::vector<Term> terms;
};

constexpr int kMaxTermsToScale = 4;
constexpr int kMaxWholeExponent = 255;  // that fits into an instruction

TapeOp TapeOpOf(Op op) {
  switch (op) {
    case Op::kDivide: return TapeOp::kDivide;
    case Op::kLess: return TapeOp::kLess;
    case Op::kLessEqual: return TapeOp::kLessEqual;
    case Op::kEqual: return TapeOp::kEqual;
    case Op::kNotEqual: return TapeOp::kNotEqual;
    case Op::kAnd: return TapeOp::kAnd;
    case Op::kOr: return TapeOp::kOr;
    case Op::kNot: return TapeOp::kNot;
    case Op::kAbs: return TapeOp::kAbs;
    case Op::kSign: return TapeOp::kSign;
    case Op::kSqrt: return TapeOp::kSqrt;
    case Op::kExp: return TapeOp::kExp;
    case Op::kLog: return TapeOp::kLog;
    case Op::kLog2: return TapeOp::kLog2;
    case Op::kLog10: return TapeOp::kLog10;
    case Op::kSin: return TapeOp::kSin;
    case Op::kCos: return TapeOp::kCos;
    case Op::kTan: return TapeOp::kTan;
    case Op::kAsin: return TapeOp::kAsin;
    case Op::kAcos: return TapeOp::kAcos;
    case Op::kAtan: return TapeOp::kAtan;
    case Op::kTanh: return TapeOp::kTanh;
    case Op::kStep: return TapeOp::kStep;
    case Op::kIf: return TapeOp::kSelect;
    default:
      throw std::invalid_argument(std::string(InfoOf(op).name) +
                                  "() of something that depends on a parameter or a state cannot run on the tape");
  }
}

/// Translates values to instructions with one register per value.
class Builder {
 public:
  Builder(Graph* graph, const TapeLayout& layout, std::vector<int> scalars)
      : graph_(*graph),
        num_parameters_(layout.num_parameters),
        advances_(layout.advances),
        scalars_(std::move(scalars)) {
    for (std::size_t s = 0; s < scalars_.size(); ++s) scalar_of_.emplace(scalars_[s], static_cast<int>(s));
    for (int r = 0; r < layout.num_parameters + layout.num_states; ++r) once_.push_back(r < num_parameters_);
  }

  /// Number of uses of each value: a value used twice is computed into a register.
  void CountUses(const std::vector<int>& results) {
    std::vector<int> open = results;
    for (const int result : results) ++uses_[result];
    while (!open.empty()) {
      const int node = open.back();
      open.pop_back();
      if (!visited_.emplace(node, true).second) continue;
      for (const int argument : graph_.at(node).argument) {
        if (argument < 0) continue;
        ++uses_[argument];
        open.push_back(argument);
      }
    }
  }

  int Register(int node) { return Materialise(Value(node)); }
  /// All operands of the node.
  void Prepare(int node) { (void)Value(node); }
  [[nodiscard]] VirtualCode Code(std::vector<int> results) const { return {code_, once_, std::move(results)}; }
  [[nodiscard]] const std::vector<int>& scalars() const noexcept { return scalars_; }

 private:
  [[nodiscard]] bool once(int value) const { return once_[static_cast<std::size_t>(value)]; }
  [[nodiscard]] int num_values() const { return static_cast<int>(once_.size()); }

  int Scalar(int node) {
    const auto [at, is_new] = scalar_of_.try_emplace(node, static_cast<int>(scalars_.size()));
    if (is_new) scalars_.push_back(node);
    return at->second;
  }

  /// Values are computed only once.
  int Emit(Virtual v) {
    const auto [at, is_new] = emitted_.try_emplace({v.op, v.number, v.registers, v.scalars}, num_values());
    if (!is_new) return at->second;
    v.to = num_values();
    v.once = std::all_of(v.registers.begin(), v.registers.end(), [&](int r) { return once(r); });
    for (const int s : v.scalars) v.once = v.once && !graph_.at(scalars_[static_cast<std::size_t>(s)]).varies;
    once_.push_back(v.once);
    code_.push_back(std::move(v));
    return code_.back().to;
  }
  int Emit(TapeOp op, std::vector<int> registers, std::vector<int> scalars = {}) {
    Virtual v;
    v.op = op;
    v.registers = std::move(registers);
    v.scalars = std::move(scalars);
    return Emit(std::move(v));
  }

  Linear OfRegister(int reg) { return {graph_.Number(0.0), {{graph_.Number(1.0), reg, -1}}}; }

  Linear Scaled(Linear value, int factor) {
    if (!graph_.IsNumber(value.constant, 0.0)) value.constant = graph_.Make(Op::kMultiply, value.constant, factor);
    for (Term& term : value.terms) term.factor = graph_.Make(Op::kMultiply, term.factor, factor);
    return value;
  }

  Linear Sum(Linear a, const Linear& b) {
    a.constant = graph_.Make(Op::kAdd, a.constant, b.constant);
    for (const Term& term : b.terms) {
      const auto same = std::find_if(a.terms.begin(), a.terms.end(),
                                     [&](const Term& t) { return t.reg == term.reg && t.other == term.other; });
      if (same == a.terms.end()) {
        a.terms.push_back(term);
      } else {
        same->factor = graph_.Make(Op::kAdd, same->factor, term.factor);
      }
    }
    std::erase_if(a.terms, [&](const Term& t) { return graph_.IsNumber(t.factor, 0.0); });
    return a;
  }

  Linear Product(const Linear& a, const Linear& b) {
    if (a.terms.empty())
      return b.terms.size() <= kMaxTermsToScale && !IsCoefficient(b) ? Scaled(b, a.constant)
                                                                     : ScaledRegister(b, a.constant);
    if (b.terms.empty()) return Product(b, a);
    // Factors of lone registers go before the product, where they may meet others.
    if (IsSingleRegister(a) && IsSingleRegister(b)) {
      const Term& x = a.terms[0];
      const Term& y = b.terms[0];
      return {graph_.Number(0.0),
              {{graph_.Make(Op::kMultiply, x.factor, y.factor), std::min(x.reg, y.reg), std::max(x.reg, y.reg)}}};
    }
    const int x = Materialise(a);
    const int y = Materialise(b);
    return {graph_.Number(0.0), {{graph_.Number(1.0), std::min(x, y), std::max(x, y)}}};
  }
  Linear ScaledRegister(const Linear& value, int factor) { return Scaled(OfRegister(Materialise(value)), factor); }
  /// In a step: a sum that is the same for every sample; it is computed once, and scaled as a whole.
  [[nodiscard]] bool IsCoefficient(const Linear& value) const {
    return advances_ && value.terms.size() > 1 && !graph_.at(value.constant).varies &&
           std::all_of(value.terms.begin(), value.terms.end(), [this](const Term& t) {
             return once(t.reg) && (t.other < 0 || once(t.other)) && !graph_.at(t.factor).varies;
           });
  }
  [[nodiscard]] bool IsSingleRegister(const Linear& value) const {
    return value.terms.size() == 1 && value.terms[0].other < 0 && graph_.IsNumber(value.constant, 0.0);
  }

  Linear Value(int node) {  // NOLINT(misc-no-recursion): as deep as the graph
    const GraphNode n = graph_.at(node);
    if (!n.sampled) return {node, {}};
    if (n.op == Op::kSymbol) return OfRegister(n.kind == SymbolKind::kParameter ? n.index : num_parameters_ + n.index);
    if (const auto known = known_.find(node); known != known_.end()) return OfRegister(known->second);
    Linear value = Computed(n);
    if (uses_[node] > 1) {
      const int reg = Materialise(value);
      known_.emplace(node, reg);
      return OfRegister(reg);
    }
    return value;
  }

  Linear Computed(const GraphNode& n) {  // NOLINT(misc-no-recursion)
    const int a = n.argument[0];
    const int b = n.argument[1];
    const int minus_one = graph_.Number(-1.0);
    switch (n.op) {
      case Op::kAdd: return Sum(Value(a), Value(b));
      case Op::kSubtract: return Sum(Value(a), Scaled(Value(b), minus_one));
      case Op::kNegate: return Scaled(Value(a), minus_one);
      case Op::kMultiply: return Product(Value(a), Value(b));
      case Op::kDivide: {
        const Linear below = Value(b);
        if (below.terms.empty()) {
          const int factor = graph_.Make(Op::kDivide, graph_.Number(1.0), below.constant);
          // A sum is divided as a whole where the divisor can be 0: infinite parts of it would have no sum.
          const bool bounded = graph_.IsNumber(factor) && std::isfinite(graph_.at(factor).value);
          const Linear above = Value(a);
          return bounded || IsSingleRegister(above) || above.terms.empty() ? Product({factor, {}}, above)
                                                                           : ScaledRegister(above, factor);
        }
        const Linear above = Value(a);
        if (above.terms.empty())
          return Scaled(OfRegister(Emit(TapeOp::kReciprocal, {Materialise(below)})), above.constant);
        const int divisor = Materialise(below);
        // A divisor that is the same for every sample is inverted once: a division takes as long as ten products.
        if (once(divisor)) return Product(above, OfRegister(Emit(TapeOp::kReciprocal, {divisor})));
        return OfRegister(Emit(TapeOp::kDivide, {Materialise(above), divisor}));
      }
      case Op::kPower: return OfRegister(Power(a, b));
      case Op::kPast: return OfRegister(Emit(TapeOp::kPast, {Register(b)}, {Scalar(a)}));
      case Op::kMin:
      case Op::kMax:
        return OfRegister(graph_.IsNumber(a) ? Bounded(n.op, Register(b), a) : Bounded(n.op, Register(a), b));
      case Op::kClamp: return OfRegister(Bounded(Op::kMin, Bounded(Op::kMax, Register(a), b), n.argument[2]));
      default: {
        std::vector<int> arguments;
        for (int i = 0; i < InfoOf(n.op).arguments; ++i) {
          if (InfoOf(n.op).memory) break;
          arguments.push_back(Register(n.argument[static_cast<std::size_t>(i)]));
        }
        return OfRegister(Emit(TapeOpOf(n.op), std::move(arguments)));
      }
    }
  }

  /// min or max; a literal bound needs no check for NaN.
  int Bounded(Op op, int reg, int bound) {  // NOLINT(misc-no-recursion)
    const bool smaller = op == Op::kMin;
    if (graph_.IsNumber(bound) && !std::isnan(graph_.at(bound).value))
      return Emit(smaller ? TapeOp::kMinS : TapeOp::kMaxS, {reg}, {Scalar(bound)});
    return Emit(smaller ? TapeOp::kMin : TapeOp::kMax, {reg, Register(bound)});
  }

  int Power(int base, int exponent) {  // NOLINT(misc-no-recursion)
    if (graph_.IsNumber(exponent)) {
      const double p = graph_.at(exponent).value;
      if (p == 2.0) {
        const int reg = Register(base);
        return Emit(TapeOp::kMultiply, {reg, reg});
      }
      if (std::floor(p) == p && std::fabs(p) <= kMaxWholeExponent) {
        Virtual v;
        v.op = TapeOp::kPowerInt;
        v.registers = {Register(base)};
        v.number = static_cast<int>(std::fabs(p));
        const int power = Emit(std::move(v));
        return p < 0.0 ? Emit(TapeOp::kReciprocal, {power}) : power;
      }
    }
    if (!graph_.at(base).sampled) {
      // For 0 a finite number below every other logarithm: 0^p is 0, and 0^0 is 1.
      const int log2 = graph_.Make(Op::kMax, graph_.Make(Op::kLog2, base), graph_.Number(-1e300));
      const Linear p = Value(exponent);
      if (IsSingleRegister(p))
        return Emit(TapeOp::kExp2S, {p.terms[0].reg}, {Scalar(graph_.Make(Op::kMultiply, p.terms[0].factor, log2))});
      return Emit(TapeOp::kExp2S, {Materialise(p)}, {Scalar(log2)});
    }
    return Emit(TapeOp::kPower, {Register(base), Register(exponent)});
  }

  int Materialise(const Linear& value) {
    if (value.terms.empty()) return Emit(TapeOp::kSplat, {}, {Scalar(value.constant)});
    const bool no_constant = graph_.IsNumber(value.constant, 0.0);
    const auto taken = [this](const Term& t) {
      return t.other >= 0 && graph_.IsNumber(t.factor, -1.0) && !once(t.reg) && !once(t.other);
    };
    std::vector<Term> plain, products, last;
    for (const Term& term : value.terms) (term.other < 0 ? plain : taken(term) ? last : products).push_back(term);
    if (products.empty() && last.empty() && plain.size() == 1 && no_constant && graph_.IsNumber(plain[0].factor, 1.0))
      return plain[0].reg;
    // Negative terms follow a positive one.
    products.insert(products.end(), last.begin(), last.end());
    // Factors before the sum that uses them, so that its parts are consecutive.
    for (Term& term : products)
      if (!graph_.IsNumber(term.factor, 1.0) && !(taken(term) && (!plain.empty() || &term != products.data()))) {
        term.reg = LinearOf(graph_.Number(0.0), {{term.factor, term.reg, -1}});
        term.factor = graph_.Number(1.0);
      }
    int sum = -1;
    if (!plain.empty()) sum = LinearOf(value.constant, plain);
    for (const Term& term : products) {
      if (sum >= 0) {
        sum = Emit(taken(term) ? TapeOp::kTakeProduct : TapeOp::kMultiplyAdd, {term.reg, term.other, sum});
      } else if (no_constant) {
        sum = Emit(TapeOp::kMultiply, {term.reg, term.other});
      } else {
        sum = Emit(TapeOp::kMultiplyAddS, {term.reg, term.other}, {Scalar(value.constant)});
      }
    }
    return sum;
  }

  /// Terms that are the same for every sample are summed separately, once.
  int LinearOf(int constant, const std::vector<Term>& terms) {
    std::vector<Term> fixed;
    std::vector<Term> moving;
    for (const Term& term : terms) (once(term.reg) && !graph_.at(term.factor).varies ? fixed : moving).push_back(term);
    const bool constant_moves = graph_.at(constant).varies;
    const bool lone = fixed.size() == 1 && graph_.IsNumber(fixed[0].factor, 1.0);
    // A single parameter is added directly.
    if (moving.empty() || fixed.empty() || (constant_moves && lone)) return Added(constant, terms);
    if (lone && graph_.IsNumber(constant, 0.0))
      return LinearInstruction(TapeOp::kAddLinear, {fixed[0].reg}, {}, moving);
    const int first =
        LinearInstruction(TapeOp::kLinear, {}, {Scalar(constant_moves ? graph_.Number(0.0) : constant)}, fixed);
    if (!constant_moves) return LinearInstruction(TapeOp::kAddLinear, {first}, {}, moving);
    moving.push_back({graph_.Number(1.0), first, -1});
    return LinearInstruction(TapeOp::kLinear, {}, {Scalar(constant)}, moving);
  }

  /// constant + terms, from one of them where that saves a product.
  int Added(int constant, std::vector<Term> terms) {
    const bool no_constant = graph_.IsNumber(constant, 0.0);
    if (terms.size() == 1 && no_constant)
      return graph_.IsNumber(terms[0].factor, 1.0) ? terms[0].reg
                                                   : Emit(TapeOp::kScale, {terms[0].reg}, {Scalar(terms[0].factor)});
    const auto whole =
        std::find_if(terms.begin(), terms.end(), [&](const Term& t) { return graph_.IsNumber(t.factor, 1.0); });
    if (!no_constant || whole == terms.end()) return LinearInstruction(TapeOp::kLinear, {}, {Scalar(constant)}, terms);
    const int reg = whole->reg;
    terms.erase(whole);
    return LinearInstruction(TapeOp::kAddLinear, {reg}, {}, terms);
  }

  int LinearInstruction(TapeOp op, std::vector<int> registers, std::vector<int> scalars,
                        const std::vector<Term>& terms) {
    for (const Term& term : terms) {
      registers.push_back(term.reg);
      scalars.push_back(Scalar(term.factor));
    }
    return Emit(op, std::move(registers), std::move(scalars));
  }

  Graph& graph_;
  int num_parameters_;
  bool advances_;
  std::vector<int> scalars_;
  std::map<int, int> scalar_of_;
  std::map<int, int> uses_;
  std::map<int, bool> visited_;
  std::map<int, int> known_;  ///< Register of a node.
  std::map<std::tuple<TapeOp, int, std::vector<int>, std::vector<int>>, int> emitted_;
  std::vector<bool> once_;  ///< Of a value: known before the first sample.
  std::vector<Virtual> code_;
};

}  // namespace

CompiledTape CompileTape(Graph* graph, const std::vector<int>& results, const TapeLayout& layout,
                         std::vector<int> scalars) {
  if (static_cast<int>(results.size()) > kMaxTapeResults)
    throw std::length_error("more than " + std::to_string(kMaxTapeResults) + " results");
  Builder builder(graph, layout, std::move(scalars));
  builder.CountUses(results);
  std::vector<int> values;
  values.reserve(results.size());
  for (const int node : layout.first) builder.Prepare(node);
  for (const int result : results) values.push_back(builder.Register(result));
  CompiledTape compiled;
  compiled.scalars = builder.scalars();
  if (compiled.scalars.size() > static_cast<std::size_t>(layout.most_scalars))
    throw std::length_error("needs more than " + std::to_string(layout.most_scalars) +
                            " different quantities that depend on no parameter");
  Tape& tape = compiled.tape;
  tape.num_parameters = layout.num_parameters;
  tape.num_states = layout.num_states;
  const VirtualCode code = builder.Code(std::move(values));
  Assemble(code, layout, &tape);
  tape.num_scalars = static_cast<int>(compiled.scalars.size());
  RecogniseShape(code, &tape);
  return compiled;
}

}  // namespace armcmc::expression
