#include "armcmc/plots/html.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace armcmc::plots {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
constexpr std::string_view kMinus = "\xE2\x88\x92";
constexpr std::string_view kDash = "\xE2\x80\x93";

/// Bytes of the UTF-8 sequence at the start of the text; 0 when it is none.
std::size_t SequenceLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first < 0xE0 ? 2 : first >= 0xE0 && first < 0xF0 ? 3 : 4;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  // Overlong forms, surrogates, and what lies beyond U+10FFFF.
  if ((first == 0xE0 && byte(1) < 0xA0) || (first == 0xED && byte(1) > 0x9F) || (first == 0xF0 && byte(1) < 0x90) ||
      (first == 0xF4 && byte(1) > 0x8F))
    return 0;
  return length;
}

std::string Superscript(int exponent) {
  static constexpr std::array<std::string_view, 10> kDigits = {
      "\xE2\x81\xB0", "\xC2\xB9",     "\xC2\xB2",     "\xC2\xB3",     "\xE2\x81\xB4",
      "\xE2\x81\xB5", "\xE2\x81\xB6", "\xE2\x81\xB7", "\xE2\x81\xB8", "\xE2\x81\xB9"};
  std::string out = exponent < 0 ? "\xE2\x81\xBB" : "";
  for (const char c : std::to_string(std::abs(exponent))) out += kDigits[static_cast<std::size_t>(c - '0')];
  return out;
}

std::string WithRealMinus(const char* digits) {
  return digits[0] == '-' ? std::string(kMinus) + (digits + 1) : std::string(digits);
}

}  // namespace

std::string ValidUtf8(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = SequenceLength(text);
    out += length == 0 ? kReplacement : text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

std::string EscapeHtml(std::string_view text) {
  std::string out;
  for (const char c : ValidUtf8(text)) {
    switch (c) {
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '&': out += "&amp;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default:
        if ((static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n') || c == 0x7F)
          out += kReplacement;
        else
          out += c;
    }
  }
  return out;
}

std::string ScriptJson(const nlohmann::json& value) {
  std::string out;
  for (const char c : value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) {
    switch (c) {
      case '<': out += "\\u003c"; break;
      case '>': out += "\\u003e"; break;
      case '&': out += "\\u0026"; break;
      default: out += c;
    }
  }
  return out;
}

std::string NumberText(double value, int digits) {
  if (!std::isfinite(value)) return std::string(kDash);
  if (value == 0.0) return "0";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*e", digits - 1, value);
  const int exponent = std::stoi(std::string(text.data()).substr(std::string(text.data()).find('e') + 1));
  if (exponent >= -4 && exponent < 7) return FixedText(value, std::max(0, digits - 1 - exponent));
  const std::string mantissa = std::string(text.data()).substr(0, std::string(text.data()).find('e'));
  return WithRealMinus(mantissa.c_str()) +
         "\xC2\xA0\xC3\x97\xC2\xA0"
         "10" +
         Superscript(exponent);
}

std::string FixedText(double value, int decimals) {
  if (!std::isfinite(value)) return std::string(kDash);
  std::array<char, 512> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  if (std::string_view(text.data()).find_first_not_of("-0.") == std::string_view::npos)  // no "-0.00"
    std::snprintf(text.data(), text.size(), "%.*f", decimals, 0.0);
  return WithRealMinus(text.data());
}

std::string PercentText(double share) {
  if (!std::isfinite(share)) return std::string(kDash);
  if (share > 0.999 && share <= 1.0) return "> 99.9 %";
  if (share >= 0.0 && share < 0.001) return "< 0.1 %";
  return FixedText(100.0 * share, 1) + " %";
}

}  // namespace armcmc::plots
