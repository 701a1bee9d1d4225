#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace armcmc {

/// Names in a text, including functions and keywords, in order, with repetitions.
[[nodiscard]] std::vector<std::string> NamesIn(std::string_view text);

[[nodiscard]] bool Mentions(std::string_view text, std::string_view name);

/// The text with names replaced, all at once. Numbers such as 1e-3 have no names in them.
[[nodiscard]] std::string WithNames(std::string_view text, const std::map<std::string, std::string>& by);

/// The text with names replaced by expressions, in parentheses where necessary.
[[nodiscard]] std::string Inserted(std::string_view text, const std::map<std::string, std::string>& by);

/// The text in parentheses, unless it is one number, name or call.
[[nodiscard]] std::string Bracketed(const std::string& text);

/// first + second in the usual notation: a sum with a negative term is a difference.
[[nodiscard]] std::string SumText(const std::string& first, const std::string& second);

/// -text in the usual notation.
[[nodiscard]] std::string NegativeText(const std::string& text);

/// The value with four digits, which a person reads.
[[nodiscard]] double ShortNumber(double value);

}  // namespace armcmc
