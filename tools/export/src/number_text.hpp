#pragma once

#include <array>
#include <charconv>
#include <string>

#include "armcmc/log_export/message_type.hpp"

namespace armcmc::log_export {

/// Appends the shortest text that reads back as the same number.
template <typename Number>
void AppendNumber(Number value, std::string* text) {
  std::array<char, 32> digits{};
  text->append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

/// Its numbers are no integers.
[[nodiscard]] inline bool IsReal(const MessageField& field) { return field.type == "double" || field.type == "float"; }

}  // namespace armcmc::log_export
