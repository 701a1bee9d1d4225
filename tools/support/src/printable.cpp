#include "armcmc/support/printable.hpp"

#include <algorithm>
#include <iostream>
#include <limits>
#include <streambuf>

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
  const unsigned last = ByteAt(text, size - 1);
  // Separators of lines, and marks that reverse the direction of what follows: U+200E, U+200F, U+2028 to U+202E,
  // U+2066 to U+2069.
  const bool is_mark =
      first == 0xE2 && ((second == 0x80 && (last == 0x8E || last == 0x8F || (last >= 0xA8 && last <= 0xAE))) ||
                        (second == 0x81 && last >= 0xA6 && last <= 0xA9));
  return is_control || is_overlong || is_no_character || is_mark ? 0 : size;
}

std::string Shown(std::string_view text, std::size_t most, std::string_view as_they_are = "") {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string shown;
  for (std::size_t count = 0; !text.empty(); ++count) {
    if (count == most) return shown + "...";
    const std::size_t size = as_they_are.find(text.front()) != std::string_view::npos ? 1 : ShownBytes(text);
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

/// The first `most` characters of text that is escaped.
std::string_view First(std::string_view text, std::size_t most) {
  std::size_t bytes = 0;
  for (std::size_t count = 0; count < most && bytes < text.size(); ++count) bytes += ShownBytes(text.substr(bytes));
  return text.substr(0, bytes);
}

/// The last `most` characters.
std::string_view Last(std::string_view text, std::size_t most) {
  std::size_t at = text.size();
  for (std::size_t count = 0; count < most && at > 0; ++count) do
      --at;
    while (at > 0 && (ByteAt(text, at) & 0xC0U) == 0x80U);
  return text.substr(at);
}

}  // namespace

std::string Escaped(std::string_view text) { return Shown(text, kAll); }

std::string Printable(std::string_view text, std::size_t most) { return Shown(text, most); }

std::string ErrorLine(std::string_view text) {
  constexpr std::size_t kLongWord = 300, kHead = 100, kTail = 60, kMost = 2000;
  std::string one_line(text);
  std::replace(one_line.begin(), one_line.end(), '\n', ' ');
  const std::string escaped = Escaped(one_line);
  std::string line;
  for (std::string_view left = escaped; !left.empty();) {
    const std::size_t end = std::min(left.find(' '), left.size());
    const std::string_view word = left.substr(0, end);
    if (word.size() <= kLongWord) {
      line += word;
    } else {
      line.append(First(word, kHead)).append("...").append(Last(word, kTail));
    }
    left.remove_prefix(end);
    for (; !left.empty() && left.front() == ' '; left.remove_prefix(1)) line += ' ';
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line.size() <= kMost ? line : std::string(First(line, kMost)) + "...";
}

class EscapedOutput::Filter : public std::streambuf {
 public:
  explicit Filter(std::ostream* stream) : stream_(stream), below_(stream->rdbuf(this)) {}
  ~Filter() override { stream_->rdbuf(below_); }
  Filter(const Filter&) = delete;
  Filter& operator=(const Filter&) = delete;

 protected:
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    const std::string shown = Shown({text, static_cast<std::size_t>(size)}, kAll, "\n\t");
    const auto bytes = static_cast<std::streamsize>(shown.size());
    return below_->sputn(shown.data(), bytes) == bytes ? size : 0;
  }
  // A single character: part of one of several bytes, which no stream operator splits, passes.
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    const char byte = traits_type::to_char_type(c);
    if ((static_cast<unsigned char>(byte) & 0x80U) != 0) return below_->sputc(byte);
    return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
  }
  int sync() override { return below_->pubsync(); }

 private:
  std::ostream* stream_;
  std::streambuf* below_;
};

EscapedOutput::EscapedOutput()
    : out_(std::make_unique<Filter>(&std::cout)), err_(std::make_unique<Filter>(&std::cerr)) {}

EscapedOutput::~EscapedOutput() = default;

}  // namespace armcmc::support
