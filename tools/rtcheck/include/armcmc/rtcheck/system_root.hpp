#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace armcmc::rtcheck {

/// /proc, /sys and /dev, or a tree that looks like them.
class SystemRoot {
 public:
  explicit SystemRoot(std::filesystem::path root) : root_(std::move(root)) {}

  /// Text of a file without the line end; nothing when it cannot be read.
  [[nodiscard]] std::optional<std::string> Text(const std::string& path) const;
  /// First number of a file.
  [[nodiscard]] std::optional<long> Number(const std::string& path) const;
  /// The line of a file that begins so, without that begin and without leading blanks.
  [[nodiscard]] std::optional<std::string> Line(const std::string& path, std::string_view begin) const;
  /// true when the file is there and this process may write it.
  [[nodiscard]] bool MayWrite(const std::string& path) const;
  [[nodiscard]] const std::filesystem::path& path() const { return root_; }

 private:
  std::filesystem::path root_;
};

/// CPUs of a list as the kernel writes it: "0,2-4". What is not understood is left out.
[[nodiscard]] std::set<int> ParseCpuList(std::string_view text);

}  // namespace armcmc::rtcheck
