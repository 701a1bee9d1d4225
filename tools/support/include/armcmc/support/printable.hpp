#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace armcmc::support {

/// Text of a file, a log or a command line as a terminal may show it: control characters (also the C1 set of Unicode),
/// marks that break a line or reverse its direction, and bytes that are not UTF-8 become \xNN. Everything else stays as
/// it is.
[[nodiscard]] std::string Escaped(std::string_view text);

/// Escaped, and cut to its first `most` characters with "..." behind: for words of a file that a message repeats, which
/// may be of any length.
[[nodiscard]] std::string Printable(std::string_view text, std::size_t most = 60);

/// The one line of an error, of which a word or the whole may be as long as a file or a command line makes it: Escaped,
/// line breaks as blanks, of each word of more than 300 characters only its first 100 and last 60, and of the whole at
/// most 2000 characters. A path of common length stays whole.
[[nodiscard]] std::string ErrorLine(std::string_view text);

/// What std::cout and std::cerr are given while this exists reaches the terminal with its control characters and bytes
/// that are not UTF-8 as \xNN, line breaks and tabs excepted. Text passes through without a buffer of its own, so that
/// threads may print as they may without it. Restores both streams at its end.
class EscapedOutput {
 public:
  EscapedOutput();
  ~EscapedOutput();
  EscapedOutput(const EscapedOutput&) = delete;
  EscapedOutput& operator=(const EscapedOutput&) = delete;

 private:
  class Filter;
  std::unique_ptr<Filter> out_;
  std::unique_ptr<Filter> err_;
};

}  // namespace armcmc::support
