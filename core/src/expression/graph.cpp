#include "armcmc/expression/graph.hpp"

#include <bit>
#include <cmath>

#include "armcmc/expression/evaluate.hpp"

namespace armcmc::expression {
namespace {

constexpr double kLn2 = 0.69314718055994530942;
constexpr double kLn10 = 2.30258509299404568402;

bool Commutes(Op op) noexcept {
  return op == Op::kAdd || op == Op::kMultiply || op == Op::kMin || op == Op::kMax || op == Op::kAnd || op == Op::kOr ||
         op == Op::kEqual || op == Op::kNotEqual;
}

bool IsLeaf(Op op) noexcept { return op == Op::kNumber || op == Op::kSymbol; }

}  // namespace

int Graph::Insert(GraphNode node) {
  const Key key{node.op, node.argument, std::bit_cast<std::uint64_t>(node.value), node.kind, node.index};
  const auto [at, is_new] = known_.try_emplace(key, size());
  if (!is_new) return at->second;
  node.memory = InfoOf(node.op).memory;
  node.varies = InfoOf(node.op).memory;
  if (node.op == Op::kSymbol) {
    node.sampled = node.kind == SymbolKind::kParameter || node.kind == SymbolKind::kState;
    node.varies =
        node.kind != SymbolKind::kParameter && node.kind != SymbolKind::kConstant && node.kind != SymbolKind::kInterval;
  }
  for (const int argument : node.argument) {
    if (argument < 0) continue;
    const GraphNode& of = this->at(argument);
    node.sampled = node.sampled || of.sampled;
    node.varies = node.varies || of.varies;
    node.memory = node.memory || of.memory;
  }
  nodes_.push_back(node);
  return size() - 1;
}

int Graph::Number(double value) {
  GraphNode node;
  node.value = value == 0.0 ? 0.0 : value;  // one zero
  return Insert(node);
}

int Graph::Symbol(SymbolKind kind, int index) {
  GraphNode node;
  node.op = Op::kSymbol;
  node.kind = kind;
  node.index = index;
  return Insert(node);
}

int Graph::Make(Op op, int a, int b, int c) {
  if (Commutes(op) && b < a) std::swap(a, b);
  if (const int simple = Simplified(op, a, b, c); simple >= 0) return simple;
  GraphNode node;
  node.op = op;
  node.argument = {a, b, c};
  return Insert(node);
}

int Graph::Simplified(Op op, int a, int b, int c) {
  const OpInfo& info = InfoOf(op);
  if (info.memory) {
    // Constants have no memory.
    const bool constant = a >= 0 && !at(a).varies;
    if (constant && op != Op::kIntegral) return a;
    if (op == Op::kLowpass || op == Op::kDelay) return IsNumber(b, 0.0) ? a : -1;
    if (op == Op::kIntegral && constant) return Make(Op::kMultiply, a, Make(Op::kElapsed));
    return -1;
  }
  const std::array<int, kMaxArguments> argument{a, b, c};
  std::array<double, kMaxArguments> value{};
  bool number = info.arguments > 0;
  for (int i = 0; i < info.arguments; ++i) {
    const auto k = static_cast<std::size_t>(i);
    number = number && IsNumber(argument[k]);
    if (number) value[k] = at(argument[k]).value;
  }
  if (number) return Number(Evaluate(op, value[0], value[1], value[2]));
  switch (op) {
    case Op::kIf:
      if (IsNumber(a)) return at(a).value != 0.0 ? b : c;
      return b == c ? b : -1;
    case Op::kMin:
    case Op::kMax: return a == b ? a : -1;
    case Op::kAnd:
      if (IsNumber(a)) return at(a).value != 0.0 ? b : a;
      if (IsNumber(b)) return at(b).value != 0.0 ? a : b;
      return -1;
    case Op::kOr:
      if (IsNumber(a)) return at(a).value == 0.0 ? b : a;
      if (IsNumber(b)) return at(b).value == 0.0 ? a : b;
      return -1;
    default: return SimplifiedArithmetic(op, a, b);
  }
}

int Graph::SimplifiedArithmetic(Op op, int a, int b) {
  switch (op) {
    case Op::kAdd:
      if (IsNumber(a, 0.0)) return b;
      return IsNumber(b, 0.0) ? a : -1;
    case Op::kSubtract:
      if (IsNumber(b, 0.0)) return a;
      if (a == b) return Number(0.0);
      return IsNumber(a, 0.0) ? Make(Op::kNegate, b) : -1;
    case Op::kMultiply:
      if (IsNumber(a, 0.0) || IsNumber(b, 0.0)) return Number(0.0);
      if (IsNumber(a, 1.0)) return b;
      if (IsNumber(b, 1.0)) return a;
      if (IsNumber(a, -1.0)) return Make(Op::kNegate, b);
      return IsNumber(b, -1.0) ? Make(Op::kNegate, a) : -1;
    case Op::kDivide:
      if (IsNumber(a, 0.0)) return a;
      return IsNumber(b, 1.0) ? a : -1;
    case Op::kPower:
      if (IsNumber(b, 1.0)) return a;
      if (IsNumber(b, 0.0)) return Number(1.0);
      return IsNumber(b, 0.5) ? Make(Op::kSqrt, a) : -1;
    case Op::kNegate: return at(a).op == Op::kNegate ? at(a).argument[0] : -1;
    default: return -1;
  }
}

int Graph::Lower(const Syntax& syntax, const Scope& scope, const std::vector<int>& let) {
  std::vector<int> made(syntax.nodes.size());
  for (std::size_t n = 0; n < syntax.nodes.size(); ++n) {
    const SyntaxNode& node = syntax.nodes[n];
    if (node.op == Op::kNumber) {
      made[n] = Number(node.value);
      continue;
    }
    if (node.op == Op::kSymbol) {
      const expression::Symbol& symbol = *scope.Find(node.name);
      switch (symbol.kind) {
        case SymbolKind::kConstant: made[n] = Number(symbol.value); break;
        case SymbolKind::kLet: made[n] = let.at(static_cast<std::size_t>(symbol.index)); break;
        default: made[n] = Symbol(symbol.kind, symbol.index);
      }
      continue;
    }
    std::array<int, kMaxArguments> argument{-1, -1, -1};
    for (std::size_t i = 0; i < kMaxArguments; ++i)
      if (node.argument[i] >= 0) argument[i] = made[static_cast<std::size_t>(node.argument[i])];
    made[n] = Make(node.op, argument[0], argument[1], argument[2]);
  }
  return made.back();
}

bool Graph::DependsOn(int node, int other) const {
  if (node == other) return true;
  std::vector<bool> needed(static_cast<std::size_t>(node) + 1, false);
  needed.back() = true;
  for (int n = node; n > other; --n) {
    if (!needed[static_cast<std::size_t>(n)]) continue;
    for (const int argument : at(n).argument) {
      if (argument == other) return true;
      if (argument >= 0) needed[static_cast<std::size_t>(argument)] = true;
    }
  }
  return false;
}

int Graph::Differentiate(int node, int by) {
  std::map<int, int> known;
  return Derivative(node, by, &known);
}

int Graph::Derivative(int node, int by, std::map<int, int>* known) {  // NOLINT(misc-no-recursion)
  if (node == by) return Number(1.0);
  if (const auto at = known->find(node); at != known->end()) return at->second;
  // A copy, since adding nodes may move the existing ones.
  const GraphNode n = this->at(node);
  if (IsLeaf(n.op) || !DependsOn(node, by)) return Number(0.0);
  const int a = n.argument[0];
  const int b = n.argument[1];
  const int c = n.argument[2];
  std::array<int, kMaxArguments> d{-1, -1, -1};
  for (std::size_t i = 0; i < kMaxArguments; ++i) {
    if (n.argument[i] < 0) continue;
    d[i] = Derivative(n.argument[i], by, known);
    if (d[i] < 0) return -1;
  }
  const auto add = [&](int x, int y) { return Make(Op::kAdd, x, y); };
  const auto subtract = [&](int x, int y) { return Make(Op::kSubtract, x, y); };
  const auto times = [&](int x, int y) { return Make(Op::kMultiply, x, y); };
  const auto over = [&](int x, int y) { return Make(Op::kDivide, x, y); };
  const auto square = [&](int x) { return times(x, x); };
  const auto one = [&] { return Number(1.0); };
  int result = -1;
  switch (n.op) {
    case Op::kAdd: result = add(d[0], d[1]); break;
    case Op::kSubtract: result = subtract(d[0], d[1]); break;
    case Op::kMultiply: result = add(times(d[0], b), times(a, d[1])); break;
    case Op::kDivide: result = over(subtract(d[0], times(node, d[1])), b); break;
    case Op::kPower: {
      // x^p (p x'/x + p' log x); p x^(p-1) x' where p is a number, which holds at x = 0, too.
      if (!DependsOn(b, by)) {
        result = times(times(b, Make(Op::kPower, a, subtract(b, one()))), d[0]);
        break;
      }
      // x^p log x goes to 0 with x.
      const int log_part = Make(Op::kIf, Make(Op::kEqual, a, Number(0.0)), Number(0.0), times(node, Make(Op::kLog, a)));
      result = times(log_part, d[1]);
      if (DependsOn(a, by)) result = add(result, times(times(b, Make(Op::kPower, a, subtract(b, one()))), d[0]));
      break;
    }
    case Op::kNegate: result = Make(Op::kNegate, d[0]); break;
    case Op::kAbs: result = times(Make(Op::kSign, a), d[0]); break;
    case Op::kSqrt: result = over(d[0], times(Number(2.0), node)); break;
    case Op::kExp: result = times(node, d[0]); break;
    case Op::kLog: result = over(d[0], a); break;
    case Op::kLog2: result = over(d[0], times(Number(kLn2), a)); break;
    case Op::kLog10: result = over(d[0], times(Number(kLn10), a)); break;
    case Op::kSin: result = times(Make(Op::kCos, a), d[0]); break;
    case Op::kCos: result = Make(Op::kNegate, times(Make(Op::kSin, a), d[0])); break;
    case Op::kTan: result = times(add(one(), square(node)), d[0]); break;
    case Op::kAsin: result = over(d[0], Make(Op::kSqrt, subtract(one(), square(a)))); break;
    case Op::kAcos: result = Make(Op::kNegate, over(d[0], Make(Op::kSqrt, subtract(one(), square(a))))); break;
    case Op::kAtan: result = over(d[0], add(one(), square(a))); break;
    case Op::kTanh: result = times(subtract(one(), square(node)), d[0]); break;
    case Op::kMin: result = Make(Op::kIf, Make(Op::kLess, a, b), d[0], d[1]); break;
    case Op::kMax: result = Make(Op::kIf, Make(Op::kLess, b, a), d[0], d[1]); break;
    case Op::kClamp:
      result = Make(Op::kIf, Make(Op::kLess, a, b), d[1], Make(Op::kIf, Make(Op::kLess, c, a), d[2], d[0]));
      break;
    case Op::kIf: result = Make(Op::kIf, a, d[1], d[2]); break;
    case Op::kLowpass:
    case Op::kDelay:
      if (DependsOn(b, by)) return -1;
      result = Make(n.op, d[0], b, c);
      break;
    case Op::kIntegral:
    case Op::kPrevious: result = Make(n.op, d[0], -1, c); break;
    default:  // conditions, sign, step: flat between their jumps
      result = Number(0.0);
  }
  known->emplace(node, result);
  return result;
}

int Graph::Substitute(int node, const std::map<int, int>& by) {
  // Arguments precede their users, so that one pass suffices.
  std::vector<int> made(static_cast<std::size_t>(node) + 1);
  for (int n = 0; n <= node; ++n) {
    const auto k = static_cast<std::size_t>(n);
    if (const auto found = by.find(n); found != by.end()) {
      made[k] = found->second;
      continue;
    }
    const GraphNode at = this->at(n);
    if (IsLeaf(at.op)) {
      made[k] = n;
      continue;
    }
    std::array<int, kMaxArguments> argument{-1, -1, -1};
    bool same = true;
    for (std::size_t i = 0; i < kMaxArguments; ++i) {
      if (at.argument[i] < 0) continue;
      argument[i] = made[static_cast<std::size_t>(at.argument[i])];
      same = same && argument[i] == at.argument[i];
    }
    made[k] = same ? n : Make(at.op, argument[0], argument[1], argument[2]);
  }
  return made.back();
}

}  // namespace armcmc::expression
