#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace armcmc {

/// Names that a text says, functions and words of the language among them, in order, repetitions included.
[[nodiscard]] std::vector<std::string> NamesIn(std::string_view text);

[[nodiscard]] bool Mentions(std::string_view text, std::string_view name);

/// The text with names replaced, all at once. Numbers such as 1e-3 have no names in them.
[[nodiscard]] std::string WithNames(std::string_view text, const std::map<std::string, std::string>& by);

/// The text with expressions put in for names, in parentheses where they need some.
[[nodiscard]] std::string Inserted(std::string_view text, const std::map<std::string, std::string>& by);

/// The text in parentheses, unless it is one number, name or call.
[[nodiscard]] std::string Bracketed(const std::string& text);

/// first + second, as a person would write it: a sum with a negative term is a difference.
[[nodiscard]] std::string SumText(const std::string& first, const std::string& second);

}  // namespace armcmc
