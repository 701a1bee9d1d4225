#include "package/page_blocks.hpp"

#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test {
namespace {

/// With runs of spaces as one, and none at the ends.
std::string Squeezed(const std::string& line) {
  std::istringstream words(line);
  std::string word, squeezed;
  while (words >> word) squeezed += (squeezed.empty() ? "" : " ") + word;
  return squeezed;
}

std::string SqueezedLines(const std::string& text) {
  std::istringstream lines(text);
  std::string line, all;
  while (std::getline(lines, line)) all += Squeezed(line) + '\n';
  return all;
}

}  // namespace

std::string PageBlock::FileName() const {
  std::istringstream first(text.substr(0, text.find('\n')));
  std::string mark, name, more;
  first >> mark >> name >> more;
  const bool is_file = (mark == "#" || mark == "//") && more.empty() && name.find('.') != std::string::npos;
  return is_file ? name : "";
}

std::vector<PageBlock> ReadBlocks(const std::filesystem::path& page) {
  std::ifstream file(page);
  if (!file) throw std::runtime_error(page.string() + ": cannot be read");
  std::vector<PageBlock> blocks;
  bool inside = false;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.starts_with("```")) {
      if (!inside) blocks.push_back({line.substr(3), "", number});
      inside = !inside;
    } else if (inside) {
      blocks.back().text += line + '\n';
    }
  }
  if (inside) throw std::runtime_error(page.string() + ": a block is not closed");
  return blocks;
}

int WriteFiles(const std::vector<PageBlock>& blocks, const std::filesystem::path& folder) {
  int written = 0;
  std::filesystem::create_directories(folder);
  for (const PageBlock& block : blocks) {
    if (block.FileName().empty()) continue;
    std::ofstream(folder / block.FileName()) << block.text;
    ++written;
  }
  return written;
}

std::vector<std::string> FollowPage(const std::filesystem::path& page, const std::filesystem::path& folder) {
  using namespace std::chrono_literals;
  std::vector<std::string> surprises;
  const auto surprise = [&](int line, const std::string& what) {
    surprises.push_back(page.string() + ':' + std::to_string(line) + ": " + what);
  };
  std::string printed;
  for (const PageBlock& block : ReadBlocks(page)) {
    if (!block.FileName().empty()) {
      WriteFiles({block}, folder);
    } else if (block.language == "sh") {
      const std::string path = "export PATH='" + Program("x").parent_path().string() + "':\"$PATH\"\n";
      const Outcome run = RunProgram("/bin/sh", {"-ec", path + block.text}, 120s, folder);
      printed = SqueezedLines(run.out + run.err);
      if (run.code != 0) surprise(block.line, "ends with " + std::to_string(run.code) + ":\n" + run.err);
    } else if (block.language == "text") {
      std::istringstream lines(block.text);
      std::string line;
      for (int number = block.line + 1; std::getline(lines, line); ++number)
        if (printed.find(Squeezed(line)) == std::string::npos)
          surprise(number, std::string("not printed: ").append(line).append("\n").append(printed));
    }
  }
  return surprises;
}

}  // namespace armcmc::test
