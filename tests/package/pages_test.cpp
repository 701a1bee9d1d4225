// What pages tell a reader to do works, and prints what they say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
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
  EXPECT_THAT(text, HasSubstr("Missing: coulomb friction, then asymmetric friction."));
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
  for (const char* room : {".github", "core", "lcm_types", "plant_sim", "rt", "tests", "tools", "README.md"}) {
    std::vector<std::filesystem::path> pages{SourceDir() / room};
    if (std::filesystem::is_directory(pages.front())) {
      pages.clear();
      for (const auto& entry : std::filesystem::recursive_directory_iterator(SourceDir() / room))
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

TEST(Pages, TheFilesThatTheArchitectureNamesAreThere) {
  std::ifstream file(SourceDir() / ".github/ARCHITECTURE.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::regex path(R"(`((core|rt|plant_sim|lcm_types|tools|tests)/[a-z0-9_/.]+)`)");
  int paths = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), path), end; it != end; ++it, ++paths)
    EXPECT_TRUE(std::filesystem::exists(SourceDir() / (*it)[1].str())) << (*it)[1];
  EXPECT_GT(paths, 30);
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
