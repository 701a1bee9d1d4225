#include "effect_units.hpp"

#include <algorithm>

#include "effect_text.hpp"

namespace armcmc {

std::optional<expression::Unit> KnownUnit(const std::string& text) {
  try {
    return expression::ParseUnit(text);
  } catch (const expression::Error&) {
    return std::nullopt;  // Plant() says what is wrong with it
  }
}

std::string UnitIn(const std::string& text, const std::map<std::string, std::string>& units) {
  bool plain_number = false;
  std::map<std::string, std::string> by;
  for (const auto& [name, unit] : units) {
    const bool one_word =
        std::all_of(unit.begin(), unit.end(), [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); });
    by[name] = one_word ? unit : '(' + unit + ')';
    const auto known = expression::ParseUnit(unit);
    plain_number = plain_number || (Mentions(text, name) && known && known->Same(expression::Unit{}));
  }
  const std::string put_in = WithNames(text, by);
  const auto unit = expression::ParseUnit(put_in);
  // N/rad^3 and N/1 are N.
  if (plain_number && unit) {
    const std::string short_text = unit->Text();
    if (expression::ParseUnit(short_text)->Same(*unit)) return short_text;
  }
  // Without parentheses around the whole.
  if (put_in.size() > 2 && put_in.front() == '(' && put_in.find(')') == put_in.size() - 1)
    return put_in.substr(1, put_in.size() - 2);
  return put_in;
}

}  // namespace armcmc
