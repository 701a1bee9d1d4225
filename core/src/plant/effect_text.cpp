#include "effect_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "armcmc/expression/operation.hpp"
#include "armcmc/expression/syntax.hpp"

namespace armcmc {
namespace {

bool IsLetter(char c) noexcept { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool IsDigit(char c) noexcept { return c >= '0' && c <= '9'; }

/// Length of the number that begins at `at`: digits, a point, an exponent.
std::size_t NumberLength(std::string_view text, std::size_t at) noexcept {
  std::size_t end = at;
  while (end < text.size() && (IsDigit(text[end]) || text[end] == '.')) ++end;
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    std::size_t exponent = end + 1;
    if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
    if (exponent < text.size() && IsDigit(text[exponent])) {
      end = exponent;
      while (end < text.size() && IsDigit(text[end])) ++end;
    }
  }
  return end - at;
}

/// Calls on_name for every name, on_other for everything else.
template <class OnName, class OnOther>
void Walk(std::string_view text, const OnName& on_name, const OnOther& on_other) {
  for (std::size_t at = 0; at < text.size();) {
    std::size_t length = 1;
    if (IsLetter(text[at])) {
      while (at + length < text.size() && (IsLetter(text[at + length]) || IsDigit(text[at + length]))) ++length;
      on_name(text.substr(at, length));
    } else {
      if (IsDigit(text[at]) || text[at] == '.') length = std::max<std::size_t>(NumberLength(text, at), 1);
      on_other(text.substr(at, length));
    }
    at += length;
  }
}

}  // namespace

std::vector<std::string> NamesIn(std::string_view text) {
  std::vector<std::string> names;
  Walk(
      text, [&](std::string_view name) { names.emplace_back(name); }, [](std::string_view) {});
  return names;
}

bool Mentions(std::string_view text, std::string_view name) {
  const std::vector<std::string> names = NamesIn(text);
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string WithNames(std::string_view text, const std::map<std::string, std::string>& by) {
  std::string renamed;
  Walk(
      text,
      [&](std::string_view name) {
        const auto found = by.find(std::string(name));
        renamed += found == by.end() ? std::string(name) : found->second;
      },
      [&](std::string_view rest) { renamed += rest; });
  return renamed;
}

std::string Inserted(std::string_view text, const std::map<std::string, std::string>& by) {
  std::string made;
  std::size_t at = 0;
  const auto is_alone = [&](std::size_t end) {
    const std::size_t before = text.substr(0, at).find_last_not_of(' ');
    const std::size_t after = text.find_first_not_of(' ', end);
    return (before == std::string_view::npos || text[before] == '(' || text[before] == ',') &&
           (after == std::string_view::npos || text[after] == ')' || text[after] == ',');
  };
  Walk(
      text,
      [&](std::string_view name) {
        const auto found = by.find(std::string(name));
        if (found == by.end()) {
          made += name;
        } else {
          made += is_alone(at + name.size()) ? found->second : Bracketed(found->second);
        }
        at += name.size();
      },
      [&](std::string_view rest) {
        made += rest;
        at += rest.size();
      });
  return made;
}

std::string Bracketed(const std::string& text) {
  const expression::Syntax syntax = expression::Parse(text);
  const expression::Op op = syntax.at(syntax.root()).op;
  const bool atom = op == expression::Op::kNumber || op == expression::Op::kSymbol || InfoOf(op).function;
  return atom ? text : '(' + text + ')';
}

std::string SumText(const std::string& first, const std::string& second) {
  if (first.empty() || first == "0") return second;
  const std::size_t begin = second.find_first_not_of(' ');
  if (begin != std::string::npos && second[begin] == '-') return first + " - " + second.substr(begin + 1);
  return first + " + " + second;
}

std::string NegativeText(const std::string& text) {
  const expression::Syntax syntax = expression::Parse(text);
  const expression::Op op = syntax.at(syntax.root()).op;
  const bool product = op == expression::Op::kMultiply || op == expression::Op::kDivide;
  if (!product) return '-' + Bracketed(text);
  return text.starts_with('-') ? text.substr(1) : '-' + text;
}

double ShortNumber(double value) {
  if (value == 0.0) return value;
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 3).ptr;
  double rounded = value;
  std::from_chars(text.data(), end, rounded);
  return rounded;
}

}  // namespace armcmc
