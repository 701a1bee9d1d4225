#include "armcmc/expression/check.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>

namespace armcmc::expression {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// A unit as far as it is known, or a literal number, which fits into any sum.
struct UnitState {
  std::optional<Unit> unit;
  bool number = false;
};

struct Known {
  UnitState unit;
  Interval range;
  bool condition = false, sampled = false, fixed = false, memory = false;
  int doubtful_power = 0;  ///< See Meaning.
};

/// lower <= name <= upper, while a condition holds.
struct Guard {
  std::string_view name;
  Interval range;
};

double Product(double a, double b) noexcept { return a == 0.0 || b == 0.0 ? 0.0 : a * b; }

Interval Hull(Interval a, Interval b) noexcept { return {std::min(a.lower, b.lower), std::max(a.upper, b.upper)}; }

Interval Cut(Interval a, Interval b) noexcept {
  const Interval cut{std::max(a.lower, b.lower), std::min(a.upper, b.upper)};
  return cut.lower <= cut.upper ? cut : b;
}

Interval Multiply(Interval a, Interval b) noexcept {
  const std::array<double, 4> corners{Product(a.lower, b.lower), Product(a.lower, b.upper), Product(a.upper, b.lower),
                                      Product(a.upper, b.upper)};
  const auto [least, most] = std::minmax_element(corners.begin(), corners.end());
  return {*least, *most};
}

Interval Divide(Interval a, Interval b) noexcept {
  if (b.lower <= 0.0 && b.upper >= 0.0) {
    // Of one sign where both are.
    if (b.lower == 0.0 && a.lower >= 0.0) return {0.0, kInf};
    return {};
  }
  return Multiply(a, {1.0 / b.upper, 1.0 / b.lower});
}

bool IsWhole(double value) noexcept { return std::floor(value) == value; }

Interval Raise(Interval base, Interval exponent) noexcept {
  if (exponent.lower == exponent.upper && IsWhole(exponent.lower)) {
    if (std::fmod(exponent.lower, 2.0) == 0.0) return {0.0, kInf};
    return base.lower >= 0.0 ? Interval{0.0, kInf} : Interval{};
  }
  return {0.0, kInf};
}

/// a over b, in the words of a and b or in those of the quotient, whichever is shorter.
std::string QuotientText(const Unit& a, const Unit& b) {
  const std::string below = b.Text();
  const bool one_word = below.find_first_of(" /") == std::string::npos;
  const std::string words = a.Text() + (one_word ? "/" + below : "/(" + below + ")");
  const std::string own = a.Over(b).Text();
  return own.size() <= words.size() ? own : words;
}

std::string HintText(double value, const std::string& unit) {
  std::array<char, 32> digits{};
  const std::string number(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
  return "; a number in a product has no unit: if " + number + " is in " + unit +
         ", name it: [constants] NAME = { value = " + number + ", unit = \"" + unit + "\" }";
}

/// What to do about a literal number in the product `node`, in `found` instead of `wanted`; empty if there is none.
std::string NumberHint(const Syntax& syntax, int node, const Unit& found, const Unit& wanted) {
  if (wanted.SameDimension(found)) return "";
  while (syntax.at(node).op == Op::kNegate) node = syntax.at(node).argument[0];
  for (; syntax.at(node).op == Op::kMultiply || syntax.at(node).op == Op::kDivide; node = syntax.at(node).argument[0])
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      const SyntaxNode* factor = &syntax.at(syntax.at(node).argument[side]);
      if (factor->op == Op::kNegate) factor = &syntax.at(factor->argument[0]);
      if (factor->op != Op::kNumber) continue;
      const bool divides = syntax.at(node).op == Op::kDivide && side == 1;
      return HintText(factor->value, divides ? QuotientText(found, wanted) : QuotientText(wanted, found));
    }
  return "";
}

class Checker {
 public:
  Checker(const Syntax& syntax, const Scope& scope) : syntax_(syntax), scope_(scope) {}

  Known Node(int node) {  // NOLINT(misc-no-recursion): as deep as the text, which is bounded
    const SyntaxNode& at = syntax_.at(node);
    Known known;
    switch (at.op) {
      case Op::kNumber:
        known.unit = {Unit{}, true};
        known.range = {at.value, at.value};
        known.fixed = true;
        return known;
      case Op::kSymbol: return OfSymbol(at);
      case Op::kIf: return Choice(at);
      default: break;
    }
    std::array<Known, kMaxArguments> a;
    const int count = InfoOf(at.op).arguments;
    known.fixed = !InfoOf(at.op).memory;
    known.memory = InfoOf(at.op).memory;
    known.condition = InfoOf(at.op).condition;
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      a[k] = Node(at.argument[k]);
      known.sampled = known.sampled || a[k].sampled;
      known.fixed = known.fixed && a[k].fixed;
      known.memory = known.memory || a[k].memory;
      if (known.doubtful_power == 0) known.doubtful_power = a[k].doubtful_power;
    }
    if (at.op == Op::kPower && CanBeNoNumber(a[0], a[1])) known.doubtful_power = at.column;
    known.unit = UnitOf(node, a);
    known.range = RangeOf(node, a);
    return known;
  }

  /// Assumes the bounds that follow from the condition.
  void Assume(const Syntax& condition, int node) {  // NOLINT(misc-no-recursion)
    const SyntaxNode& at = condition.at(node);
    if (at.op == Op::kAnd) {
      Assume(condition, at.argument[0]);
      Assume(condition, at.argument[1]);
      return;
    }
    if (at.op != Op::kLess && at.op != Op::kLessEqual && at.op != Op::kEqual) return;
    const SyntaxNode& left = condition.at(at.argument[0]);
    const SyntaxNode& right = condition.at(at.argument[1]);
    const Checker sides(condition, scope_);
    if (left.op == Op::kSymbol)
      guards_.push_back(
          {left.name,
           {at.op == Op::kEqual ? sides.Bounds(at.argument[1]).lower : -kInf, sides.Bounds(at.argument[1]).upper}});
    if (right.op == Op::kSymbol)
      guards_.push_back(
          {right.name,
           {sides.Bounds(at.argument[0]).lower, at.op == Op::kEqual ? sides.Bounds(at.argument[0]).upper : kInf}});
  }

 private:
  [[nodiscard]] Interval Bounds(int node) const {
    Checker copy = *this;
    return copy.Node(node).range;
  }

  Known OfSymbol(const SyntaxNode& at) const {
    const Symbol* symbol = scope_.Find(at.name);
    if (symbol == nullptr) throw UnknownName(at.column, at.name, "name");
    Known known;
    known.unit = {symbol->unit, false};
    known.range = symbol->range;
    for (const Guard& guard : guards_)
      if (guard.name == at.name) known.range = Cut(known.range, guard.range);
    known.condition = symbol->condition;
    known.sampled = symbol->sampled || symbol->kind == SymbolKind::kParameter || symbol->kind == SymbolKind::kState;
    known.fixed = symbol->fixed || symbol->kind == SymbolKind::kConstant;
    return known;
  }

  Known Choice(const SyntaxNode& at) {  // NOLINT(misc-no-recursion)
    const Known condition = Node(at.argument[0]);
    NeedCondition(at.argument[0], condition);
    const std::size_t before = guards_.size();
    Assume(syntax_, at.argument[0]);
    const Known yes = Node(at.argument[1]);
    guards_.resize(before);
    const Known no = Node(at.argument[2]);
    Known known;
    known.unit = CommonUnit(at.column, yes.unit, no.unit, "the two results of if");
    known.range = Hull(yes.range, no.range);
    known.condition = yes.condition && no.condition;
    known.sampled = condition.sampled || yes.sampled || no.sampled;
    known.fixed = condition.fixed && yes.fixed && no.fixed;
    known.memory = condition.memory || yes.memory || no.memory;
    for (const Known* part : {&condition, &yes, &no})
      if (known.doubtful_power == 0) known.doubtful_power = part->doubtful_power;
    return known;
  }

  void NeedCondition(int node, const Known& known) const {
    if (!known.condition) throw Error(syntax_.FirstColumn(node), "expected a condition such as x >= 0, found a number");
  }

  static std::string Name(const UnitState& state) { return state.unit ? state.unit->Text() : "an unknown unit"; }

  /// CommonUnit() of the two sides of a sum or comparison.
  [[nodiscard]] UnitState UnitOfSides(const SyntaxNode& at, const UnitState& a, const UnitState& b,
                                      std::string_view what) const {
    try {
      return CommonUnit(at.column, a, b, what);
    } catch (const Error& error) {
      std::string hint = NumberHint(syntax_, at.argument[1], *b.unit, *a.unit);
      if (hint.empty()) hint = NumberHint(syntax_, at.argument[0], *a.unit, *b.unit);
      throw Error(error.column(), error.what() + hint);
    }
  }

  static UnitState CommonUnit(int column, const UnitState& a, const UnitState& b, std::string_view what) {
    if (a.number || b.number) return a.number && !b.number ? b : a;
    if (!a.unit || !b.unit) return a.unit ? a : b;
    if (a.unit->Same(*b.unit)) return a;
    std::string message = "units do not match: " + std::string(what) + Name(a) + " and " + Name(b);
    if (a.unit->SameDimension(*b.unit)) message += ", which differ by a factor";
    throw Error(column, message);
  }

  void NeedNumber(int node, const UnitState& state, std::string_view function) const {
    if (!state.unit || state.unit->Same(Unit{})) return;
    std::string message = std::string(function) + " takes a number without a unit, found " + Name(state);
    if (state.unit->IsNumber()) message += " (angles are in rad)";
    throw Error(syntax_.FirstColumn(node), message);
  }

  void NeedTime(int node, const UnitState& state, std::string_view function) const {
    Unit second;
    second.exponent[2] = 1.0;
    if (!state.unit || state.number || state.unit->Same(second)) return;
    throw Error(syntax_.FirstColumn(node),
                "the second argument of " + std::string(function) + " is a time in s, found " + Name(state));
  }

  UnitState UnitOf(int node, const std::array<Known, kMaxArguments>& a) const {
    const SyntaxNode& at = syntax_.at(node);
    const UnitState& x = a[0].unit;
    const UnitState& y = a[1].unit;
    const UnitState plain{Unit{}, false};
    switch (at.op) {
      case Op::kAdd:
      case Op::kSubtract: return UnitOfSides(at, x, y, at.op == Op::kAdd ? "the sum is of " : "the difference is of ");
      case Op::kMin:
      case Op::kMax: return CommonUnit(at.column, x, y, "the comparison is of ");
      case Op::kLess:
      case Op::kLessEqual:
      case Op::kEqual:
      case Op::kNotEqual: (void)UnitOfSides(at, x, y, "the comparison is of "); return plain;
      case Op::kClamp:
        return CommonUnit(at.column, CommonUnit(at.column, x, y, "a value and its bound"), a[2].unit,
                          "a value and its bound");
      case Op::kMultiply:
      case Op::kDivide:
        if (!x.unit || !y.unit) return {};
        return {at.op == Op::kMultiply ? x.unit->Times(*y.unit) : x.unit->Over(*y.unit), x.number && y.number};
      case Op::kPower:
        NeedNumber(at.argument[1], y, "an exponent");
        if (!x.unit || x.number) return x;
        if (a[1].fixed && a[1].range.lower == a[1].range.upper) return {x.unit->Power(a[1].range.lower), false};
        return x.unit->Same(Unit{}) ? x : UnitState{};
      case Op::kSqrt: return x.unit ? UnitState{x.unit->Power(0.5), x.number} : x;
      case Op::kNegate:
      case Op::kAbs:
      case Op::kPrevious: return x;
      case Op::kAnd:
      case Op::kOr: NeedCondition(at.argument[1], a[1]); [[fallthrough]];
      case Op::kNot: NeedCondition(at.argument[0], a[0]); return plain;
      case Op::kSign:
      case Op::kStep: return plain;
      case Op::kLowpass:
      case Op::kDelay: NeedTime(at.argument[1], y, InfoOf(at.op).name); return x;
      case Op::kIntegral:
      case Op::kElapsed: {
        Unit second;
        second.exponent[2] = 1.0;
        if (at.op == Op::kElapsed) return {second, false};
        return x.unit ? UnitState{x.unit->Times(second), false} : UnitState{};
      }
      default: NeedNumber(at.argument[0], x, InfoOf(at.op).name); return plain;
    }
  }

  Interval RangeOf(int node, const std::array<Known, kMaxArguments>& a) const {
    const SyntaxNode& at = syntax_.at(node);
    const Interval x = a[0].range;
    const Interval y = a[1].range;
    const auto map = [&](double (*f)(double)) noexcept { return Interval{f(x.lower), f(x.upper)}; };
    switch (at.op) {
      case Op::kAdd: return {x.lower + y.lower, x.upper + y.upper};
      case Op::kSubtract:
        // x - x and the like are simplified elsewhere.
        return {x.lower - y.upper, x.upper - y.lower};
      case Op::kMultiply: return SameText(at.argument[0], at.argument[1]) ? Raise(x, {2.0, 2.0}) : Multiply(x, y);
      case Op::kDivide: return Divide(x, y);
      case Op::kPower:
        CheckPower(at, a[0], a[1]);
        if (a[0].fixed && a[1].fixed && x.lower == x.upper && y.lower == y.upper)
          return {std::pow(x.lower, y.lower), std::pow(x.lower, y.lower)};
        return Raise(x, y);
      case Op::kNegate: return {-x.upper, -x.lower};
      case Op::kAbs:
        if (x.lower >= 0.0) return x;
        if (x.upper <= 0.0) return {-x.upper, -x.lower};
        return {0.0, std::max(-x.lower, x.upper)};
      case Op::kSqrt: return {std::sqrt(std::max(x.lower, 0.0)), std::sqrt(std::max(x.upper, 0.0))};
      case Op::kExp: return map([](double v) { return std::exp(v); });
      case Op::kSign:
        return {x.lower >= 0.0 ? (x.lower > 0.0 ? 1.0 : 0.0) : -1.0,
                x.upper <= 0.0 ? (x.upper < 0.0 ? -1.0 : 0.0) : 1.0};
      case Op::kTanh: return map([](double v) { return std::tanh(v); });
      case Op::kSin:
      case Op::kCos: return {-1.0, 1.0};
      case Op::kAsin:
      case Op::kAtan: return {-1.5707963267948968, 1.5707963267948968};
      case Op::kAcos: return {0.0, 3.1415926535897936};
      case Op::kMin: return {std::min(x.lower, y.lower), std::min(x.upper, y.upper)};
      case Op::kMax: return {std::max(x.lower, y.lower), std::max(x.upper, y.upper)};
      case Op::kClamp:
        return {std::min(std::max(x.lower, y.lower), a[2].range.upper),
                std::max(std::min(x.upper, a[2].range.upper), y.lower)};
      case Op::kStep:
      case Op::kLess:
      case Op::kLessEqual:
      case Op::kEqual:
      case Op::kNotEqual:
      case Op::kAnd:
      case Op::kOr:
      case Op::kNot: return {0.0, 1.0};
      case Op::kLowpass:
      case Op::kDelay:
      case Op::kPrevious: return x;
      case Op::kIntegral: return {x.lower >= 0.0 ? 0.0 : -kInf, x.upper <= 0.0 ? 0.0 : kInf};
      case Op::kElapsed: return {0.0, kInf};
      default: return {};
    }
  }

  static bool CanBeNoNumber(const Known& base, const Known& exponent) noexcept {
    const bool whole = exponent.fixed && exponent.range.lower == exponent.range.upper && IsWhole(exponent.range.lower);
    return !whole && base.range.lower < 0.0;
  }

  void CheckPower(const SyntaxNode& at, const Known& base, const Known& exponent) const {
    if (base.sampled || !CanBeNoNumber(base, exponent)) return;
    throw Error(at.column,
                "the base of this power can be negative, and its exponent is not a whole number: write max(.., 0)^.., "
                "abs(..)^.., or guard it with a mode or an if of x >= 0");
  }

  [[nodiscard]] bool SameText(int a, int b) const {  // NOLINT(misc-no-recursion)
    const SyntaxNode& x = syntax_.at(a);
    const SyntaxNode& y = syntax_.at(b);
    if (x.op != y.op || x.name != y.name || x.value != y.value) return false;
    for (std::size_t i = 0; i < kMaxArguments; ++i)
      if ((x.argument[i] < 0) != (y.argument[i] < 0) || (x.argument[i] >= 0 && !SameText(x.argument[i], y.argument[i])))
        return false;
    return true;
  }

  const Syntax& syntax_;
  const Scope& scope_;
  std::vector<Guard> guards_;
};

}  // namespace

std::vector<std::string> Scope::Names() const {
  std::vector<std::string> names;
  names.reserve(symbols_.size());
  for (const Symbol& symbol : symbols_) names.push_back(symbol.name);
  return names;
}

Meaning Check(const Syntax& syntax, const Scope& scope, const Syntax* given) {
  Checker checker(syntax, scope);
  if (given != nullptr) checker.Assume(*given, given->root());
  const Known known = checker.Node(syntax.root());
  Meaning meaning;
  if (!known.unit.number) meaning.unit = known.unit.unit;
  meaning.range = known.range;
  meaning.condition = known.condition;
  meaning.sampled = known.sampled;
  meaning.fixed = known.fixed;
  meaning.memory = known.memory;
  meaning.doubtful_power = known.doubtful_power;
  return meaning;
}

void Expect(const Meaning& meaning, const std::optional<Unit>& unit, const Syntax& syntax, std::string_view what) {
  if (!unit || !meaning.unit || unit->Same(*meaning.unit)) return;
  throw Error(syntax.FirstColumn(syntax.root()), std::string(what) + " is " + meaning.unit->Text() + ", expected " +
                                                     unit->Text() +
                                                     NumberHint(syntax, syntax.root(), *meaning.unit, *unit));
}

}  // namespace armcmc::expression
