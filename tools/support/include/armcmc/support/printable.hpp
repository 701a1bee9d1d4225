#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace armcmc::support {

/// Text of a file, a log or a command line as a terminal may show it: control characters (also the C1 set of Unicode)
/// and bytes that are not UTF-8 become \xNN. Everything else stays as it is.
[[nodiscard]] std::string Escaped(std::string_view text);

/// Escaped, and cut to its first `most` characters with "..." behind: for words of a file that a message repeats, which
/// may be of any length.
[[nodiscard]] std::string Printable(std::string_view text, std::size_t most = 60);

}  // namespace armcmc::support
