// What pages tell a reader to do works, and prints what they say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "package/page_blocks.hpp"
#include "support/paths.hpp"

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
  EXPECT_THAT(FollowPage(SourceDir() / "README.md", dir.path()), IsEmpty());
}

// What the two above rest on.
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
