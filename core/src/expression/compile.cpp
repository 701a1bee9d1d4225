#include "armcmc/expression/compile.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

namespace armcmc::expression {
namespace {

/// factor x register, or factor x register x other.
struct Term {
  int factor = -1;  ///< Node.
  int reg = -1;
  int other = -1;
};

/// constant + sum of the terms: a value that is not computed yet.
struct Linear {
  int constant = -1;  ///< Node.
  std::vector<Term> terms;
};

/// An instruction on registers of which there are as many as values.
struct Virtual {
  TapeOp op = TapeOp::kCopy;
  int to = -1;
  std::vector<int> registers;  ///< That it reads, in order.
  std::vector<int> scalars;    ///< Likewise.
  int number = 0;              ///< A small number that belongs to it: an exponent.
  bool once = false;
};

constexpr int kMaxTermsToScale = 4;
constexpr int kMaxWholeExponent = 64;

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
    case Op::kMin: return TapeOp::kMin;
    case Op::kMax: return TapeOp::kMax;
    case Op::kStep: return TapeOp::kStep;
    case Op::kIf: return TapeOp::kSelect;
    default:
      throw std::invalid_argument(std::string(InfoOf(op).name) +
                                  "() of something that depends on a parameter or a state cannot run on the tape");
  }
}

/// From values to instructions on as many registers as there are values.
class Builder {
 public:
  Builder(Graph* graph, int num_parameters, int num_states, std::vector<int> scalars)
      : graph_(*graph),
        num_parameters_(num_parameters),
        num_fixed_(num_parameters + num_states),
        scalars_(std::move(scalars)) {
    for (std::size_t s = 0; s < scalars_.size(); ++s) scalar_of_.emplace(scalars_[s], static_cast<int>(s));
    for (int r = 0; r < num_fixed_; ++r) once_.push_back(r < num_parameters);
  }

  /// How often each value is asked for: what is asked for twice is computed into a register.
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
  [[nodiscard]] const std::vector<Virtual>& code() const noexcept { return code_; }
  [[nodiscard]] const std::vector<int>& scalars() const noexcept { return scalars_; }
  [[nodiscard]] int num_values() const noexcept { return static_cast<int>(once_.size()); }
  [[nodiscard]] int num_fixed() const noexcept { return num_fixed_; }
  [[nodiscard]] bool once(int value) const { return once_[static_cast<std::size_t>(value)]; }

 private:
  int Scalar(int node) {
    const auto [at, is_new] = scalar_of_.try_emplace(node, static_cast<int>(scalars_.size()));
    if (is_new) scalars_.push_back(node);
    return at->second;
  }

  int Emit(Virtual v) {
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
      return b.terms.size() <= kMaxTermsToScale ? Scaled(b, a.constant) : ScaledRegister(b, a.constant);
    if (b.terms.empty()) return Product(b, a);
    // Factors of lone registers go before the product, where they may meet others.
    if (IsLone(a) && IsLone(b)) {
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
  [[nodiscard]] bool IsLone(const Linear& value) const {
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
          return bounded || IsLone(above) || above.terms.empty() ? Product({factor, {}}, above)
                                                                 : ScaledRegister(above, factor);
        }
        const Linear above = Value(a);
        if (above.terms.empty())
          return Scaled(OfRegister(Emit(TapeOp::kReciprocal, {Materialise(below)})), above.constant);
        return OfRegister(Emit(TapeOp::kDivide, {Materialise(above), Materialise(below)}));
      }
      case Op::kPower: return OfRegister(Power(a, b));
      case Op::kClamp: {
        const int floor = Emit(TapeOp::kMax, {Register(a), Register(b)});
        return OfRegister(Emit(TapeOp::kMin, {floor, Register(n.argument[2])}));
      }
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

  int Power(int base, int exponent) {  // NOLINT(misc-no-recursion)
    if (graph_.IsNumber(exponent)) {
      const double p = graph_.at(exponent).value;
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
      // Of 0 a number that is below every other, and finite: 0^p is 0, and 0^0 is 1.
      const int log2 = graph_.Make(Op::kMax, graph_.Make(Op::kLog2, base), graph_.Number(-1e300));
      const Linear p = Value(exponent);
      if (IsLone(p))
        return Emit(TapeOp::kExp2S, {p.terms[0].reg}, {Scalar(graph_.Make(Op::kMultiply, p.terms[0].factor, log2))});
      return Emit(TapeOp::kExp2S, {Materialise(p)}, {Scalar(log2)});
    }
    return Emit(TapeOp::kPower, {Register(base), Register(exponent)});
  }

  int Materialise(const Linear& value) {
    if (value.terms.empty()) return Emit(TapeOp::kSplat, {}, {Scalar(value.constant)});
    const bool no_constant = graph_.IsNumber(value.constant, 0.0);
    std::vector<Term> plain;
    std::vector<Term> products;
    for (const Term& term : value.terms) (term.other < 0 ? plain : products).push_back(term);
    if (products.empty() && plain.size() == 1 && no_constant && graph_.IsNumber(plain[0].factor, 1.0))
      return plain[0].reg;
    int sum = -1;
    if (!plain.empty()) sum = LinearOf(value.constant, plain);
    for (const Term& term : products) {
      const int left =
          graph_.IsNumber(term.factor, 1.0) ? term.reg : LinearOf(graph_.Number(0.0), {{term.factor, term.reg, -1}});
      if (sum >= 0) {
        sum = Emit(TapeOp::kMultiplyAdd, {left, term.other, sum});
      } else if (no_constant) {
        sum = Emit(TapeOp::kMultiply, {left, term.other});
      } else {
        sum = Emit(TapeOp::kMultiplyAddS, {left, term.other}, {Scalar(value.constant)});
      }
    }
    return sum;
  }

  /// What needs no sample is added up apart, once.
  int LinearOf(int constant, const std::vector<Term>& terms) {
    std::vector<Term> fixed;
    std::vector<Term> moving;
    for (const Term& term : terms) (once(term.reg) && !graph_.at(term.factor).varies ? fixed : moving).push_back(term);
    const bool constant_moves = graph_.at(constant).varies;
    const bool lone = fixed.size() == 1 && graph_.IsNumber(fixed[0].factor, 1.0);
    // A lone parameter is best added where it is.
    if (moving.empty() || fixed.empty() || (constant_moves && lone))
      return LinearInstruction(TapeOp::kLinear, {}, {Scalar(constant)}, terms);
    if (lone && graph_.IsNumber(constant, 0.0))
      return LinearInstruction(TapeOp::kAddLinear, {fixed[0].reg}, {}, moving);
    const int first =
        LinearInstruction(TapeOp::kLinear, {}, {Scalar(constant_moves ? graph_.Number(0.0) : constant)}, fixed);
    if (!constant_moves) return LinearInstruction(TapeOp::kAddLinear, {first}, {}, moving);
    moving.push_back({graph_.Number(1.0), first, -1});
    return LinearInstruction(TapeOp::kLinear, {}, {Scalar(constant)}, moving);
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
  int num_fixed_;
  std::vector<int> scalars_;
  std::map<int, int> scalar_of_;
  std::map<int, int> uses_;
  std::map<int, bool> visited_;
  std::map<int, int> known_;  ///< Register of a node.
  std::vector<bool> once_;    ///< Of a value: known before the first sample.
  std::vector<Virtual> code_;
};

/// Gives values that are alive at the same time registers of their own, and writes the code down.
class Assembler {
 public:
  Assembler(const Builder& builder, const std::vector<int>& results, Tape* tape) : tape_(*tape) {
    for (const bool once : {true, false})
      for (const Virtual& v : builder.code())
        if (v.once == once) order_.push_back(&v);
    last_use_.assign(static_cast<std::size_t>(builder.num_values()), -1);
    for (std::size_t i = 0; i < order_.size(); ++i)
      for (const int r : order_[i]->registers) last_use_[static_cast<std::size_t>(r)] = static_cast<int>(i);
    const int never = static_cast<int>(order_.size());
    for (const int result : results) last_use_[static_cast<std::size_t>(result)] = never;
    for (int value = 0; value < builder.num_values(); ++value) {
      // What is computed once, or handed in, is there for every sample.
      const bool stays = value < builder.num_fixed() ||
                         (builder.once(value) && last_use_[static_cast<std::size_t>(value)] >= NumOnce());
      if (stays) last_use_[static_cast<std::size_t>(value)] = never;
    }
    place_.assign(static_cast<std::size_t>(builder.num_values()), -1);
    for (int value = 0; value < builder.num_fixed(); ++value) place_[static_cast<std::size_t>(value)] = value;
    used_ = builder.num_fixed();
  }

  void Write() {
    for (std::size_t i = 0; i < order_.size(); ++i) {
      One(*order_[i], static_cast<int>(i));
      if (order_[i]->once) tape_.once = tape_.size;
    }
    tape_.num_registers = used_;
  }
  [[nodiscard]] int Place(int value) const { return place_[static_cast<std::size_t>(value)]; }

 private:
  [[nodiscard]] int NumOnce() const {
    return static_cast<int>(std::count_if(order_.begin(), order_.end(), [](const Virtual* v) { return v->once; }));
  }

  void One(const Virtual& v, int at) {
    std::vector<int> from;
    for (const int r : v.registers) from.push_back(Place(r));
    for (const int r : v.registers)
      if (last_use_[static_cast<std::size_t>(r)] == at) Free(Place(r));
    const int to = Take();
    place_[static_cast<std::size_t>(v.to)] = to;
    if (last_use_[static_cast<std::size_t>(v.to)] < 0) Free(to);

    TapeInstruction i;
    i.op = v.op;
    i.to = Byte(to);
    const auto scalar = [&](std::size_t s) { return Byte(v.scalars.at(s)); };
    switch (v.op) {
      case TapeOp::kLinear:
      case TapeOp::kAddLinear: {
        const std::size_t head = v.op == TapeOp::kLinear ? 0 : 1;
        i.a = head == 0 ? scalar(0) : Byte(from[0]);
        const std::size_t count = from.size() - head;
        i.b = Byte(static_cast<int>(count));
        Append(i);
        for (std::size_t t = 0; t < count; t += 2) {
          TapeInstruction pair;
          const std::size_t s = 1 - head;
          pair.to = Byte(from[head + t]);
          pair.a = scalar(s + t);
          if (t + 1 < count) {
            pair.b = Byte(from[head + t + 1]);
            pair.c = scalar(s + t + 1);
          }
          Append(pair);
        }
        return;
      }
      case TapeOp::kSplat: i.a = scalar(0); break;
      case TapeOp::kExp2S:
        i.a = Byte(from[0]);
        i.b = scalar(0);
        break;
      case TapeOp::kPowerInt:
        i.a = Byte(from[0]);
        i.b = Byte(v.number);
        break;
      case TapeOp::kMultiplyAddS:
        i.a = Byte(from[0]);
        i.b = Byte(from[1]);
        i.c = scalar(0);
        break;
      default:
        if (!from.empty()) i.a = Byte(from[0]);
        if (from.size() > 1) i.b = Byte(from[1]);
        if (from.size() > 2) i.c = Byte(from[2]);
    }
    Append(i);
  }

  static std::uint8_t Byte(int value) { return static_cast<std::uint8_t>(value); }

  void Append(const TapeInstruction& i) {
    if (tape_.size == kMaxTapeInstructions)
      throw std::length_error("needs more than " + std::to_string(kMaxTapeInstructions) + " instructions a sample");
    tape_.code[static_cast<std::size_t>(tape_.size++)] = i;
  }
  int Take() {
    if (!free_.empty()) {
      const int r = free_.back();
      free_.pop_back();
      return r;
    }
    if (used_ == kMaxTapeRegisters)
      throw std::length_error("needs more than " + std::to_string(kMaxTapeRegisters) +
                              " intermediate values at a time");
    return used_++;
  }
  void Free(int place) {
    if (std::find(free_.begin(), free_.end(), place) == free_.end()) free_.push_back(place);
  }

  Tape& tape_;
  std::vector<const Virtual*> order_;
  std::vector<int> last_use_;  ///< Of a value: the instruction that reads it last.
  std::vector<int> place_;     ///< Of a value: its register.
  std::vector<int> free_;
  int used_ = 0;
};

/// The sum that the instruction at `at` computes from parameters; none where it is something else.
std::optional<TapeSum> SumAt(const Tape& tape, int at) {
  const TapeInstruction& i = tape.code[static_cast<std::size_t>(at)];
  const bool from_register = i.op == TapeOp::kAddLinear;
  if ((i.op != TapeOp::kLinear && !from_register) || i.b + (from_register ? 1 : 0) > kMaxShapeTerms)
    return std::nullopt;
  TapeSum sum;
  if (from_register) {
    sum.parameter[sum.count] = i.a;
    sum.scalar[sum.count++] = TapeSum::kNone;
  } else {
    sum.constant = i.a;
  }
  for (std::size_t t = 0; t < i.b; ++t) {
    const TapeInstruction& pair = tape.code[static_cast<std::size_t>(at) + 1 + t / 2];
    sum.parameter[sum.count] = t % 2 == 0 ? pair.to : pair.b;
    sum.scalar[sum.count++] = t % 2 == 0 ? pair.a : pair.c;
  }
  for (std::size_t t = 0; t < sum.count; ++t)
    if (sum.parameter[t] >= tape.num_parameters) return std::nullopt;
  return sum;
}

int LengthAt(const Tape& tape, int at) {
  const TapeInstruction& i = tape.code[static_cast<std::size_t>(at)];
  return i.op == TapeOp::kLinear || i.op == TapeOp::kAddLinear ? 1 + (i.b + 1) / 2 : 1;
}

/// Finds out whether the tape has a form with a loop of its own.
void RecogniseShape(Tape* tape) {
  if (tape->once != 0 || tape->num_results != 1 || tape->num_states != 0) return;
  std::array<int, 4> start{};
  int count = 0;
  for (int at = 0; at < tape->size; at += LengthAt(*tape, at)) {
    if (count == static_cast<int>(start.size())) return;
    start[static_cast<std::size_t>(count++)] = at;
  }
  const auto code = [&](int n) -> const TapeInstruction& {
    return tape->code[static_cast<std::size_t>(start[static_cast<std::size_t>(n)])];
  };
  if (count == 1) {
    const std::optional<TapeSum> sum = SumAt(*tape, 0);
    if (!sum) return;
    tape->rest = *sum;
    tape->shape = TapeShape::kLinear;
    return;
  }
  // A power, its factor (a sum or a parameter), and their product, added to a scalar or a sum; in any order.
  if (count < 2) return;
  const TapeInstruction& last = code(count - 1);
  const bool adds_scalar = last.op == TapeOp::kMultiplyAddS;
  if (!adds_scalar && last.op != TapeOp::kMultiplyAdd) return;
  const TapeInstruction* power = nullptr;
  for (int n = 0; n + 1 < count; ++n)
    if (code(n).op == TapeOp::kExp2S && power == nullptr) power = &code(n);
  if (power == nullptr || power->a >= tape->num_parameters || (last.a != power->to && last.b != power->to)) return;
  const std::uint8_t other = last.a == power->to ? last.b : last.a;
  std::optional<TapeSum> factor;
  std::optional<TapeSum> rest;
  if (other < tape->num_parameters) {
    factor.emplace();
    factor->count = 1;
    factor->parameter[0] = other;
    factor->scalar[0] = TapeSum::kNone;
  }
  if (adds_scalar) rest.emplace().constant = last.c;
  for (int n = 0; n + 1 < count; ++n) {
    if (&code(n) == power) continue;
    const std::optional<TapeSum> sum = SumAt(*tape, start[static_cast<std::size_t>(n)]);
    if (!sum) return;
    if (code(n).to == other && !factor) {
      factor = sum;
    } else if (!adds_scalar && code(n).to == last.c && !rest) {
      rest = sum;
    } else {
      return;
    }
  }
  if (!factor || !rest) return;
  tape->factor = *factor;
  tape->rest = *rest;
  tape->exponent = power->a;
  tape->log2 = power->b;
  tape->shape = TapeShape::kPower;
}

}  // namespace

CompiledTape CompileTape(Graph* graph, const std::vector<int>& results, int num_parameters, int num_states,
                         std::vector<int> scalars) {
  if (static_cast<int>(results.size()) > kMaxTapeResults)
    throw std::length_error("more than " + std::to_string(kMaxTapeResults) + " results");
  Builder builder(graph, num_parameters, num_states, std::move(scalars));
  builder.CountUses(results);
  std::vector<int> values;
  values.reserve(results.size());
  for (const int result : results) values.push_back(builder.Register(result));
  CompiledTape compiled;
  compiled.scalars = builder.scalars();
  if (compiled.scalars.size() > static_cast<std::size_t>(kMaxTapeScalars))
    throw std::length_error("needs more than " + std::to_string(kMaxTapeScalars) +
                            " different quantities that depend on no parameter");
  Tape& tape = compiled.tape;
  tape.num_parameters = num_parameters;
  tape.num_states = num_states;
  Assembler assembler(builder, values, &tape);
  assembler.Write();
  for (std::size_t r = 0; r < values.size(); ++r)
    tape.result[r] = static_cast<std::uint8_t>(assembler.Place(values[r]));
  tape.num_results = static_cast<int>(results.size());
  tape.num_scalars = static_cast<int>(compiled.scalars.size());
  RecogniseShape(&tape);
  return compiled;
}

}  // namespace armcmc::expression
