#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace armcmc::test {

/// A fenced block of a page in Markdown.
struct PageBlock {
  std::string language;  ///< The word behind the fence, such as "sh"; empty where there is none.
  std::string text;      ///< Lines between the fences.
  int line = 0;          ///< Line of the opening fence, from 1.

  /// The file that the block holds: the name in its first line when that is a comment of one word, "# name.toml" or
  /// "// main.cpp". Empty where it is none.
  [[nodiscard]] std::string FileName() const;
};

/// All fenced blocks of a page, in order. @throws std::runtime_error when the page cannot be read or a fence is open.
[[nodiscard]] std::vector<PageBlock> ReadBlocks(const std::filesystem::path& page);

/// Writes every block that is a file to `folder`. @return how many.
int WriteFiles(const std::vector<PageBlock>& blocks, const std::filesystem::path& folder);

/// Does in `folder` what a reader of the page does: writes its files, runs its `sh` blocks, in order, with the programs
/// of this build on the path, and looks for every line of a `text` block in what the `sh` block before it printed,
/// whatever the spaces.
/// @return what went otherwise than the page says, each with the line of the page; empty when all is as it says.
[[nodiscard]] std::vector<std::string> FollowPage(const std::filesystem::path& page,
                                                  const std::filesystem::path& folder);

}  // namespace armcmc::test
