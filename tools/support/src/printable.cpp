#include "armcmc/support/printable.hpp"

#include <limits>

namespace armcmc::support {
namespace {

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

unsigned ByteAt(std::string_view text, std::size_t at) { return static_cast<unsigned char>(text[at]); }

/// Bytes of the character that begins the text; 0 where there is none that a terminal may be given.
std::size_t ShownBytes(std::string_view text) {
  const unsigned first = ByteAt(text, 0);
  if (first < 0x80) return first >= 0x20 && first != 0x7F ? 1 : 0;
  const std::size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < size) return 0;
  for (std::size_t i = 1; i < size; ++i)
    if ((ByteAt(text, i) & 0xC0U) != 0x80U) return 0;
  const unsigned second = ByteAt(text, 1);
  const bool is_control = first == 0xC2 && second < 0xA0;
  const bool is_overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool is_no_character = (first == 0xED && second >= 0xA0) || (first == 0xF4 && second >= 0x90);
  return is_control || is_overlong || is_no_character ? 0 : size;
}

std::string Shown(std::string_view text, std::size_t most) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string shown;
  for (std::size_t count = 0; !text.empty(); ++count) {
    if (count == most) return shown + "...";
    const std::size_t size = ShownBytes(text);
    if (size == 0) {
      const unsigned byte = ByteAt(text, 0);
      shown += {'\\', 'x', kDigits[byte >> 4U], kDigits[byte & 15U]};
    } else {
      shown += text.substr(0, size);
    }
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return shown;
}

}  // namespace

std::string Escaped(std::string_view text) { return Shown(text, kAll); }

std::string Printable(std::string_view text, std::size_t most) { return Shown(text, most); }

}  // namespace armcmc::support
