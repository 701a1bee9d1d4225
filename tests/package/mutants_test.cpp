// The faults that tests/mutation/run plants: a fault whose line has changed is planted no more.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <toml++/toml.h>

#include "support/paths.hpp"

namespace armcmc::test::mutants_test {
namespace {

namespace fs = std::filesystem;

std::string Contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Mutants, StandExactlyOnceInTheirFiles) {
  int count = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(SourceDir() / "tests/mutation")) {
    if (entry.path().extension() != ".toml") continue;
    const toml::table list = toml::parse_file(entry.path().string());
    for (const toml::node& node : *list["mutant"].as_array()) {
      const toml::table& mutant = *node.as_table();
      const std::string from = mutant["from"].value_or("");
      const std::string text = Contents(SourceDir() / mutant["file"].value_or(""));
      const std::size_t at = text.find(from);
      ASSERT_FALSE(from.empty());
      EXPECT_TRUE(at != std::string::npos && text.find(from, at + 1) == std::string::npos)
          << entry.path().filename() << ": " << mutant["name"].value_or("");
      EXPECT_NE(std::string(mutant["to"].value_or("")).find("MUTANT"), std::string::npos);
      ++count;
    }
  }
  EXPECT_GE(count, 40);
}

}  // namespace
}  // namespace armcmc::test::mutants_test
