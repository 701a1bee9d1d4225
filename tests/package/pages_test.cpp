// What pages tell a reader to do works, and prints what they say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "package/page_blocks.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::pages_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string TextOf(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Pages, TheTutorialOfAPlantWorks) {
  const ScratchDir dir;
  EXPECT_THAT(FollowPage(SourceDir() / "core/plants/README.md", dir.path()), IsEmpty());
}

TEST(Pages, ThePlantAndTheCsvOfTheReadmeWork) {
  const ScratchDir dir;
  // Its reader stands at the top of a tree that is built.
  std::filesystem::create_directory_symlink(SourceDir() / "tools", dir / "tools");
  std::filesystem::create_directory_symlink(Program("x").parent_path().parent_path(), dir / "build");
  EXPECT_THAT(FollowPage(SourceDir() / "README.md", dir.path()), IsEmpty());
  for (const char* made : {"motor.csv", "estimates.csv", "axis/report.html", "axis/model.toml"})
    EXPECT_TRUE(std::filesystem::exists(dir / made)) << made;
  // What the caption of its report says, and the name that it shows.
  const std::string result = TextOf(dir / "axis/result.json"), readme = TextOf(SourceDir() / "README.md");
  std::smatch caption, before, after;
  ASSERT_TRUE(std::regex_search(readme, caption, std::regex(R"(the error falls from ([0-9.]+) to ([0-9.]+) N\])")));
  ASSERT_TRUE(std::regex_search(result, before, std::regex(R"("heldout_rmse_before": ([0-9.]+))")));
  ASSERT_TRUE(std::regex_search(result, after, std::regex(R"("heldout_rmse_after": ([0-9.]+))")));
  // The picture is of an earlier run: fits move by less than a percent.
  EXPECT_NEAR(std::stod(caption[1]) / std::stod(before[1]), 1.0, 0.01);
  EXPECT_NEAR(std::stod(caption[2]) / std::stod(after[1]), 1.0, 0.01);
}

TEST(Pages, TheExampleOfARecordingFileWorks) {
  const ScratchDir dir;
  std::filesystem::create_directory_symlink(SourceDir() / "tools", dir / "tools");
  std::filesystem::create_directory_symlink(Program("x").parent_path().parent_path(), dir / "build");
  EXPECT_THAT(FollowPage(SourceDir() / "tools/replay/RECORDINGS.md", dir.path()), IsEmpty());
}

TEST(Pages, ResultsAreMadeByTheCommandsThatTheyShow) {
  const ScratchDir dir;
  const Outcome run =
      RunProgram(SourceDir() / "tools/results",
                 {"--quick", "--build", Program("x").parent_path().parent_path(), "--out", dir.path(), "recordings"});
  EXPECT_EQ(run.code, 0) << run.err;
  std::ifstream file(dir / "tools/gap/recordings/RESULTS.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(text,
              HasSubstr("$ armcmc-gap --recording tools/gap/recordings/excerpt/emps_excerpt.toml --out OUT/excerpt\n"));
  EXPECT_THAT(text, HasSubstr("Missing: Coulomb friction, then asymmetric friction."));
  // Friction in both directions, another for each of them, and an offset of the force: two sums are known, and printed.
  EXPECT_THAT(text, HasSubstr("coulomb_friction Fc = "));
  EXPECT_THAT(text, HasSubstr(" N, confounded with off, asymmetric_friction_Fp, asymmetric_friction_Fm\n"));
  EXPECT_THAT(text, ::testing::ContainsRegex("determined: asymmetric_friction_Fp \\+ off \\+ coulomb_friction_Fc = "
                                             "[0-9.]+ \\+- 0[.0-9]+ N\n"));
  const Outcome usage = RunProgram(SourceDir() / "tools/results", {"nothing"});
  EXPECT_EQ(usage.code, 2);
}

// Who has run the first command of the README can go on with the page, and with the tutorial.
TEST(Pages, TheDemoBuildsTheProgramsThatReadmeAndTutorialCall) {
  const auto text_of = [](const std::filesystem::path& path) {
    std::ifstream file(path);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  const std::string demo = text_of(SourceDir() / "tools/demo");
  const std::size_t begin = demo.find("\ntargets=(");
  ASSERT_NE(begin, std::string::npos);
  const std::string targets = demo.substr(begin, demo.find(')', begin) + 1 - begin);
  const std::regex call(R"((\nbuild/bin/|\n)(armcmc-[a-z]+) )");
  int calls = 0;
  for (const char* page : {"README.md", "core/plants/README.md"}) {
    const std::string text = text_of(SourceDir() / page);
    for (std::sregex_iterator it(text.begin(), text.end(), call), end; it != end; ++it, ++calls)
      EXPECT_TRUE(std::regex_search(targets, std::regex("[( ]" + (*it)[2].str() + "[ )]"))) << page << ": " << (*it)[2];
  }
  EXPECT_GT(calls, 8);
}

// A link to a file that is not there, or a page that has grown.
TEST(Pages, LinksLeadToFilesAndPagesAreShort) {
  const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\))");
  int links = 0;
  for (const char* folder : {".github", "core", "lcm_types", "plant_sim", "rt", "tests", "tools", "README.md"}) {
    std::vector<std::filesystem::path> pages{SourceDir() / folder};
    if (std::filesystem::is_directory(pages.front())) {
      pages.clear();
      for (const auto& entry : std::filesystem::recursive_directory_iterator(SourceDir() / folder))
        if (entry.path().extension() == ".md") pages.push_back(entry.path());
    }
    for (const std::filesystem::path& page : pages) {
      std::ifstream file(page);
      const std::string text{std::istreambuf_iterator<char>(file), {}};
      EXPECT_LE(std::count(text.begin(), text.end(), '\n'), page == SourceDir() / "README.md" ? 150 : 200) << page;
      for (std::sregex_iterator it(text.begin(), text.end(), link), end; it != end; ++it, ++links)
        EXPECT_TRUE(std::filesystem::exists(page.parent_path() / (*it)[1].str())) << page << ": " << (*it)[1];
    }
  }
  EXPECT_GT(links, 30);
}

/// Files and folders of the tree from its top, "core/src/settings.cpp".
std::vector<std::string> Tree() {
  const std::vector<std::string> folders{".ci", ".github", "core", "lcm_types", "plant_sim", "rt", "tests", "tools"};
  std::vector<std::string> paths = folders;
  for (const std::string& folder : folders)
    for (const auto& entry : std::filesystem::recursive_directory_iterator(SourceDir() / folder))
      paths.push_back(entry.path().lexically_relative(SourceDir()).string());
  return paths;
}

/// A file or folder that a page names: from the top, or by the end of its path; NAME and * stand for any.
struct Named {
  std::string text;
  std::regex whole, below;
};
std::vector<Named> NamedIn(const std::string& page) {
  static const std::regex word(R"(`([A-Za-z0-9_./*]+)`)");
  static const std::regex is_path(R"(.*/.*|.*\.(cpp|hpp|inl|java|lcm))");
  std::vector<Named> all;
  for (std::sregex_iterator it(page.begin(), page.end(), word), end; it != end; ++it) {
    std::string text = (*it)[1].str();
    if (!std::regex_match(text, is_path)) continue;
    std::string pattern = std::regex_replace(text, std::regex(R"(\.)"), "\\.");
    pattern = std::regex_replace(pattern, std::regex(R"(\*)"), "[^/]*");
    pattern = std::regex_replace(pattern, std::regex("NAME"), "[a-z0-9_]+");
    const bool is_folder = pattern.back() == '/';
    if (is_folder) pattern.pop_back();
    all.push_back({text, std::regex("(.*/)?" + pattern), std::regex((is_folder ? "" : "(.*/)?") + pattern + "/.*")});
  }
  return all;
}

TEST(Pages, TheFilesThatTheArchitectureNamesAreThere) {
  const std::vector<std::string> tree = Tree();
  const std::vector<Named> all = NamedIn(TextOf(SourceDir() / ".github/ARCHITECTURE.md"));
  for (const Named& named : all)
    EXPECT_TRUE(std::any_of(tree.begin(), tree.end(), [&](const std::string& path) {
      return std::regex_match(path, named.whole);
    })) << named.text;
  EXPECT_GT(all.size(), 100U);
}

bool HasWord(const std::string& text, const std::string& word) {
  const auto is_part = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_part(text[at - 1])) && (end == text.size() || !is_part(text[end]))) return true;
  }
  return false;
}

// Each of the five changes has been made before. Every source that knows such an example is named where the page tells
// how to make the next one, by itself, by its folder, or as the header of a source that is named.
TEST(Pages, TheArchitectureNamesEveryPlaceOfTheFiveChanges) {
  struct Change {
    std::string title;
    std::vector<std::string> words;  // of the example
    std::size_t fewest;              // sources that have one
  };
  const std::vector<Change> changes{
      {"A new noise law", {"kLaplace", "\"laplace\"", "\"outlier_scale\""}, 15},
      {"A new effect", {"\"cogging\"", "\"stribeck_friction\""}, 0},
      {"A new effect", {"\"stress_relaxation\""}, 5},
      {"A new field on a channel", {"change_t", "EST_CHANGE", "kChangeChannel"}, 8},
      {"A new fault", {"kReorder", "\"reorder\"", "FAULT_NUMERIC", "kSqueeze", "\"squeeze\""}, 8},
      {"A new section in the gap report", {"RunAlong", "AddRunAlong", "result.run", "result->run"}, 7},
  };
  const std::string page = TextOf(SourceDir() / ".github/ARCHITECTURE.md");
  const std::regex is_source(R"((core|rt|plant_sim|tools|lcm_types)/.*\.(cpp|hpp|inl|java|lcm)|tools/gap/.*\.toml)");
  std::vector<std::pair<std::string, std::string>> sources;
  for (const std::string& path : Tree())
    if (std::regex_match(path, is_source)) sources.emplace_back(path, TextOf(SourceDir() / path));
  for (const Change& change : changes) {
    const std::size_t begin = page.find("\n**" + change.title + "**\n");
    ASSERT_NE(begin, std::string::npos) << change.title;
    const std::vector<Named> all = NamedIn(page.substr(begin, page.find("\n**", begin + 1) - begin));
    const auto is_named = [&](const std::string& path) {
      return std::any_of(all.begin(), all.end(), [&](const Named& named) {
        const bool its_header = path.ends_with(".hpp") && named.text.ends_with(".cpp") &&
                                std::filesystem::path(path).stem() == std::filesystem::path(named.text).stem();
        return its_header || std::regex_match(path, named.whole) || std::regex_match(path, named.below);
      });
    };
    std::size_t found = 0;
    for (const auto& [path, text] : sources) {
      if (std::none_of(change.words.begin(), change.words.end(),
                       [&source = text](const std::string& word) { return HasWord(source, word); }))
        continue;
      ++found;
      EXPECT_TRUE(is_named(path)) << change.title << " does not name " << path;
    }
    EXPECT_GE(found, change.fewest) << change.title;
  }
}

// What the tests above rest on.
TEST(Pages, FollowingAPageNoticesWhatIsOtherwise) {
  const ScratchDir dir;
  std::ofstream(dir / "page.md") << "```toml\n# made.toml\nx = 1\n```\n"
                                    "```sh\ncat made.toml; echo 'one   two'\n```\n"
                                    "```text\none two\nthree\n```\n"
                                    "```sh\nexit 3\n```\n"
                                    "```\nexit 4\n```\n";
  EXPECT_THAT(FollowPage(dir / "page.md", dir.path()),
              ElementsAre(HasSubstr("page.md:10: not printed: three"), HasSubstr("page.md:12: ends with 3")));
}

}  // namespace
}  // namespace armcmc::test::pages_test
