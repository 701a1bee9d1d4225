#include "armcmc/support/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace armcmc::support::scratch_folder_test {
namespace {

namespace fs = std::filesystem;

TEST(ScratchFolder, IsThereWhileItLivesAndGoesWithWhatIsInIt) {
  fs::path path;
  {
    const ScratchFolder folder("armcmc-test"), other("armcmc-test");
    path = folder.path();
    EXPECT_NE(path, other.path());
    std::ofstream(path / "data.csv") << "t\n";
    EXPECT_TRUE(fs::exists(path / "data.csv"));
    EXPECT_EQ(path.filename().string().rfind("armcmc-test-", 0), 0U);
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(ScratchFolder, StaysWhenItIsKept) {
  fs::path path;
  {
    ScratchFolder folder("armcmc-test");
    path = folder.path();
    folder.Keep();
  }
  EXPECT_TRUE(fs::exists(path));
  fs::remove_all(path);
}

TEST(ScratchFolder, SaysWhichFolderCannotBeMade) {
  EXPECT_THROW(ScratchFolder("no-such-folder/armcmc"), std::runtime_error);
}

}  // namespace
}  // namespace armcmc::support::scratch_folder_test
