#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::layout_test {
namespace {

namespace fs = std::filesystem;

const std::set<std::string> kTopLevel = {"CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md", "core",
                                         "lcm_types",      "plant_sim",         "rt",      "tests",     "tools"};

/// What a build leaves, or an estimator that was started here.
bool IsMade(const std::string& name) {
  return name == "build" || name == "gap_logs" || name.starts_with("build-") || name == "compile_commands.json" ||
         name == "CMakeUserPresets.json";
}

/// First parts of the paths that git tracks here; empty if this is no clone.
std::set<std::string> TrackedTopLevel() {
  std::istringstream paths(
      RunProgram("/usr/bin/env", {"git", "-c", "safe.directory=*", "-C", SourceDir().string(), "ls-files"}).out);
  std::set<std::string> names;
  for (std::string path; std::getline(paths, path);) names.insert(path.substr(0, path.find('/')));
  return names;
}

// In a clone, a user's own files beside those of the project do not count.
TEST(Layout, TheTopLevelIsFixed) {
  std::set<std::string> names = TrackedTopLevel();
  if (names.empty())
    for (const fs::directory_entry& entry : fs::directory_iterator(SourceDir())) names.insert(entry.path().filename());
  std::erase_if(names, [](const std::string& name) { return name.starts_with('.') || IsMade(name); });
  EXPECT_EQ(names, kTopLevel);
}

TEST(Layout, NothingIsLeftToDo) {
  // In two pieces, so that this file does not find itself.
  const std::set<std::string> marks = {std::string("TO") + "DO", std::string("FIX") + "ME",
                                       std::string("XX") + "X:", std::string("HA") + "CK"};
  const std::set<std::string> text_files = {".hpp", ".cpp", ".txt",  ".cmake", ".toml",
                                            ".lcm", ".md",  ".json", ".java",  ""};
  int files = 0;
  for (const std::string& top : kTopLevel) {
    const fs::path root = SourceDir() / top;
    std::vector<fs::path> paths;
    if (fs::is_directory(root)) {
      for (const auto& entry : fs::recursive_directory_iterator(root))
        if (entry.is_regular_file() && text_files.contains(entry.path().extension())) paths.push_back(entry.path());
    } else {
      paths.push_back(root);
    }
    for (const fs::path& path : paths) {
      std::ifstream file(path, std::ios::binary);
      const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
      for (const std::string& mark : marks) EXPECT_EQ(text.find(mark), std::string::npos) << path << " holds " << mark;
      ++files;
    }
  }
  EXPECT_GT(files, 20);
}

// They are the reference of the library: equation, shapes, units, errors, real-time class and source.
TEST(Layout, FourTenthsOfTheLinesOfInstalledHeadersAreDocumentation) {
  const std::regex header(R"(include/armcmc/[a-z_/]+\.hpp)"), comment(R"(\s*//.*|.*///<.*)"), blank(R"(\s*)");
  double lines = 0.0, documented = 0.0;
  int headers = 0;
  for (const char* part : {"core", "rt"}) {
    std::ifstream cmake(SourceDir() / part / "CMakeLists.txt");
    const std::string text{std::istreambuf_iterator<char>(cmake), std::istreambuf_iterator<char>()};
    const std::size_t begin = text.find("FILE_SET HEADERS");
    ASSERT_NE(begin, std::string::npos) << part;
    const std::string list = text.substr(begin, text.find(')', begin) - begin);
    for (std::sregex_iterator it(list.begin(), list.end(), header), end; it != end; ++it, ++headers) {
      std::ifstream file(SourceDir() / part / it->str());
      double own = 0.0, own_documented = 0.0;
      for (std::string line; std::getline(file, line);) {
        if (std::regex_match(line, blank)) continue;
        own += 1.0;
        own_documented += std::regex_match(line, comment) ? 1.0 : 0.0;
      }
      EXPECT_GE(own_documented / own, 0.33) << part << '/' << it->str();
      lines += own;
      documented += own_documented;
    }
  }
  EXPECT_GT(headers, 60);
  EXPECT_GE(documented / lines, 0.43);
}

}  // namespace
}  // namespace armcmc::test::layout_test
