#include "armcmc/expression/unit.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace armcmc::expression {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kSameExponent = 1e-9;
constexpr double kSameScale = 1e-9;  // relative
constexpr std::array<std::string_view, Unit::kBases> kBaseNames{"m", "kg", "s", "A", "K", "mol", "cd"};

struct Named {
  std::string_view name;
  double scale;
  std::array<double, Unit::kBases> exponent;
  bool prefixes;
};

// A unit of the SI stands before others of its size: Text() takes the first that fits.
constexpr std::array<Named, 46> kNamed{{
    {"m", 1.0, {1, 0, 0, 0, 0, 0, 0}, true},
    {"g", 1e-3, {0, 1, 0, 0, 0, 0, 0}, true},
    {"s", 1.0, {0, 0, 1, 0, 0, 0, 0}, true},
    {"A", 1.0, {0, 0, 0, 1, 0, 0, 0}, true},
    {"K", 1.0, {0, 0, 0, 0, 1, 0, 0}, true},
    {"mol", 1.0, {0, 0, 0, 0, 0, 1, 0}, true},
    {"cd", 1.0, {0, 0, 0, 0, 0, 0, 1}, true},
    {"N", 1.0, {1, 1, -2, 0, 0, 0, 0}, true},
    {"Pa", 1.0, {-1, 1, -2, 0, 0, 0, 0}, true},
    {"J", 1.0, {2, 1, -2, 0, 0, 0, 0}, true},
    {"W", 1.0, {2, 1, -3, 0, 0, 0, 0}, true},
    {"C", 1.0, {0, 0, 1, 1, 0, 0, 0}, true},
    {"V", 1.0, {2, 1, -3, -1, 0, 0, 0}, true},
    {"F", 1.0, {-2, -1, 4, 2, 0, 0, 0}, true},
    {"Ohm", 1.0, {2, 1, -3, -2, 0, 0, 0}, true},
    {"ohm", 1.0, {2, 1, -3, -2, 0, 0, 0}, true},
    {"S", 1.0, {-2, -1, 3, 2, 0, 0, 0}, true},
    {"Wb", 1.0, {2, 1, -2, -1, 0, 0, 0}, true},
    {"T", 1.0, {0, 1, -2, -1, 0, 0, 0}, true},
    {"H", 1.0, {2, 1, -2, -2, 0, 0, 0}, true},
    {"Hz", 1.0, {0, 0, -1, 0, 0, 0, 0}, true},
    {"rad", 1.0, {}, true},
    {"sr", 1.0, {}, false},
    {"deg", kPi / 180.0, {}, false},
    {"rev", 2.0 * kPi, {}, false},
    {"rpm", 2.0 * kPi / 60.0, {0, 0, -1, 0, 0, 0, 0}, false},
    {"percent", 1e-2, {}, false},
    {"%", 1e-2, {}, false},
    {"count", 1.0, {}, false},
    {"counts", 1.0, {}, false},
    {"px", 1.0, {}, false},
    {"dB", 1.0, {}, false},
    {"degC", 1.0, {0, 0, 0, 0, 1, 0, 0}, false},
    {"min", 60.0, {0, 0, 1, 0, 0, 0, 0}, false},
    {"h", 3600.0, {0, 0, 1, 0, 0, 0, 0}, false},
    {"L", 1e-3, {3, 0, 0, 0, 0, 0, 0}, true},
    {"l", 1e-3, {3, 0, 0, 0, 0, 0, 0}, true},
    {"bar", 1e5, {-1, 1, -2, 0, 0, 0, 0}, true},
    {"atm", 101325.0, {-1, 1, -2, 0, 0, 0, 0}, false},
    {"psi", 6894.757293168361, {-1, 1, -2, 0, 0, 0, 0}, false},
    {"in", 0.0254, {1, 0, 0, 0, 0, 0, 0}, false},
    {"lbf", 4.4482216152605, {1, 1, -2, 0, 0, 0, 0}, false},
    {"mmHg", 133.322387415, {-1, 1, -2, 0, 0, 0, 0}, false},
    {"Ah", 3600.0, {0, 0, 1, 1, 0, 0, 0}, true},
    {"Wh", 3600.0, {2, 1, -2, 0, 0, 0, 0}, true},
    {"\xce\xa9", 1.0, {2, 1, -3, -2, 0, 0, 0}, true},
}};

struct Prefix {
  std::string_view name;
  double scale;
};
constexpr std::array<Prefix, 14> kPrefixes{{{"T", 1e12},
                                            {"G", 1e9},
                                            {"M", 1e6},
                                            {"k", 1e3},
                                            {"h", 1e2},
                                            {"d", 1e-1},
                                            {"c", 1e-2},
                                            {"m", 1e-3},
                                            {"u", 1e-6},
                                            {"\xc2\xb5", 1e-6},
                                            {"\xce\xbc", 1e-6},
                                            {"n", 1e-9},
                                            {"p", 1e-12},
                                            {"f", 1e-15}}};

std::optional<Unit> Find(std::string_view name) noexcept {
  const auto named = [](std::string_view wanted, bool prefixed) noexcept {
    return std::find_if(kNamed.begin(), kNamed.end(),
                        [&](const Named& unit) { return unit.name == wanted && (!prefixed || unit.prefixes); });
  };
  if (const auto* const found = named(name, false); found != kNamed.end()) return Unit{found->scale, found->exponent};
  for (const Prefix& prefix : kPrefixes) {
    if (!name.starts_with(prefix.name)) continue;
    if (const auto* const found = named(name.substr(prefix.name.size()), true); found != kNamed.end())
      return Unit{prefix.scale * found->scale, found->exponent};
  }
  return std::nullopt;
}

bool IsUnitByte(char c) noexcept {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '%' ||
         static_cast<unsigned char>(c) >= 0x80;
}
bool IsUnitDigit(char c) noexcept { return c >= '0' && c <= '9'; }

/// A unit, or none: one that depends on a parameter.
using MaybeUnit = std::optional<Unit>;

class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : text_(text) {}

  MaybeUnit Whole() {
    SkipBlanks();
    if (text_.substr(at_) == "-") return Unit{};  // the sign that tables use for a plain number
    if (AtEnd()) throw Error(1, "the unit is empty: a plain number has the unit 1");
    MaybeUnit unit = Product(0);
    if (!AtEnd()) Fail("expected a unit, found '" + std::string(1, text_[at_]) + "'");
    return unit;
  }

 private:
  static constexpr int kMaxDepth = 16;

  [[nodiscard]] bool AtEnd() const noexcept { return at_ == text_.size(); }
  [[nodiscard]] char Peek() const noexcept { return AtEnd() ? '\0' : text_[at_]; }
  void SkipBlanks() noexcept {
    while (Peek() == ' ') ++at_;
  }
  [[noreturn]] void Fail(const std::string& what) const { throw Error(static_cast<int>(at_) + 1, what); }
  bool Take(std::string_view what) noexcept {
    if (text_.substr(at_, what.size()) != what) return false;
    at_ += what.size();
    return true;
  }

  MaybeUnit Product(int depth) {
    if (depth > kMaxDepth) Fail("too many parentheses");
    MaybeUnit product = Factor(depth);
    for (;;) {
      SkipBlanks();
      const bool divides = Take("/");
      if (!divides && !Take("*")) Take("\xc2\xb7");  // the middle dot
      SkipBlanks();
      if (AtEnd() || Peek() == ')') {
        if (divides) Fail("expected a unit after /");
        return product;
      }
      const MaybeUnit factor = Factor(depth);
      product =
          product && factor ? MaybeUnit(divides ? product->Over(*factor) : product->Times(*factor)) : std::nullopt;
    }
  }

  MaybeUnit Factor(int depth) {
    MaybeUnit unit = Atom(depth);
    SkipBlanks();
    if (Take("\xc2\xb2")) return unit ? MaybeUnit(unit->Power(2.0)) : std::nullopt;
    if (Take("\xc2\xb3")) return unit ? MaybeUnit(unit->Power(3.0)) : std::nullopt;
    if (!Take("^")) return unit;
    const std::optional<double> exponent = Exponent();
    return unit && exponent ? MaybeUnit(unit->Power(*exponent)) : std::nullopt;
  }

  MaybeUnit Atom(int depth) {
    if (Take("sqrt(")) {
      MaybeUnit unit = Product(depth + 1);
      if (!Take(")")) Fail("expected \")\"");
      return unit ? MaybeUnit(unit->Power(0.5)) : std::nullopt;
    }
    if (Take("(")) {
      MaybeUnit unit = Product(depth + 1);
      if (!Take(")")) Fail("expected \")\"");
      return unit;
    }
    if (IsUnitDigit(Peek()) || Peek() == '.') {
      Unit unit;
      unit.scale = Number();
      if (!(unit.scale > 0.0)) Fail("a unit is not 0");
      return unit;
    }
    const std::size_t first = at_;
    while (IsUnitByte(Peek()) && text_.substr(at_, 2) != "\xc2\xb2" && text_.substr(at_, 2) != "\xc2\xb3" &&
           text_.substr(at_, 2) != "\xc2\xb7")
      ++at_;
    const std::string_view name = text_.substr(first, at_ - first);
    if (name.empty()) Fail("expected a unit, found '" + std::string(1, Peek()) + "'");
    MaybeUnit unit = Find(name);
    if (!unit) {
      at_ = first;
      Fail("unknown unit \"" + std::string(name) + "\": units of the SI, products written with a space (\"N s/m\"); " +
           "a plain number has the unit 1");
    }
    return unit;
  }

  double Number() {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc{}) Fail("a number that cannot be read");
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }

  /// A number, or (number), (number/number); nothing where it has a name in it.
  std::optional<double> Exponent() {
    SkipBlanks();
    if (!Take("(")) {
      const bool negative = Take("-");
      if (IsUnitByte(Peek())) {
        while (IsUnitByte(Peek()) || IsUnitDigit(Peek())) ++at_;
        return std::nullopt;
      }
      if (!IsUnitDigit(Peek()) && Peek() != '.') Fail("expected an exponent");
      const double value = Number();
      return negative ? -value : value;
    }
    const std::size_t close = text_.find(')', at_);
    if (close == std::string_view::npos) Fail("expected \")\"");
    const std::string_view inside = text_.substr(at_, close - at_);
    if (std::any_of(inside.begin(), inside.end(), IsUnitByte)) {
      at_ = close + 1;
      return std::nullopt;
    }
    const bool negative = Take("-");
    double value = Number();
    if (Take("/")) {
      const double divisor = Number();
      if (divisor == 0.0) Fail("an exponent is not divided by 0");
      value /= divisor;
    }
    if (!Take(")")) Fail("expected \")\"");
    return negative ? -value : value;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

std::string Shortest(double value) {
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return std::string(digits.data(), end);
}

std::string PowerOf(std::string_view name, double exponent) {
  std::string text(name);
  if (exponent != 1.0) text += '^' + Shortest(std::round(exponent * 1e9) / 1e9);
  return text;
}

}  // namespace

bool Unit::SameDimension(const Unit& other) const noexcept {
  for (std::size_t b = 0; b < kBases; ++b)
    if (std::fabs(exponent[b] - other.exponent[b]) > kSameExponent) return false;
  return true;
}

bool Unit::Same(const Unit& other) const noexcept {
  return SameDimension(other) && std::fabs(scale / other.scale - 1.0) < kSameScale;
}

Unit Unit::Times(const Unit& other) const noexcept {
  Unit product{scale * other.scale, exponent};
  for (std::size_t b = 0; b < kBases; ++b) product.exponent[b] += other.exponent[b];
  return product;
}

Unit Unit::Power(double power) const noexcept {
  Unit result{std::pow(scale, power), exponent};
  for (double& e : result.exponent) e *= power;
  return result;
}

std::string Unit::Text() const {
  if (IsNumber() && std::fabs(scale - 1.0) < kSameScale) return "1";
  for (const Named& named : kNamed)
    // 1/s may be an angle's rate as well as a frequency.
    if (named.name != "g" && named.name != "Hz" && Same(Unit{named.scale, named.exponent}))
      return std::string(named.name);
  std::string above;
  std::string below;
  for (std::size_t b = 0; b < kBases; ++b) {
    const double e = exponent[b];
    if (std::fabs(e) <= kSameExponent) continue;
    std::string& side = e > 0.0 ? above : below;
    side += e > 0.0 ? (side.empty() ? "" : " ") : "/";
    side += PowerOf(kBaseNames[b], std::fabs(e));
  }
  std::string text = above.empty() ? "1" : above;
  text += below;
  if (std::fabs(scale - 1.0) >= kSameScale) text = Shortest(scale) + ' ' + text;
  return text;
}

std::optional<Unit> ParseUnit(std::string_view text) { return UnitParser(text).Whole(); }

}  // namespace armcmc::expression
