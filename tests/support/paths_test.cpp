#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "support/paths.hpp"

namespace armcmc::test {
namespace {

TEST(Paths, SourceDirHoldsTheTopLevelCMakeFile) {
  EXPECT_TRUE(std::filesystem::is_regular_file(SourceDir() / "CMakeLists.txt"));
}

TEST(Paths, DataIsLookedForInTheFolderOfTheEnvironment) {
  const ScratchDir dir;
  std::ofstream(dir / "some.csv") << "t\n";
  setenv("ARMCMC_DATA", dir.path().c_str(), 1);
  EXPECT_EQ(FindData("some.csv"), dir / "some.csv");
  EXPECT_FALSE(FindData("absent.csv").has_value());
  EXPECT_NE(DataSkipReason("absent.csv").find((dir / "absent.csv").string()), std::string::npos);
  unsetenv("ARMCMC_DATA");
}

TEST(Paths, ScratchDirIsGoneAfterItsLife) {
  std::filesystem::path path;
  {
    const ScratchDir dir;
    path = dir.path();
    std::ofstream(dir / "file") << "x";
    EXPECT_TRUE(std::filesystem::exists(path));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(TestBus, GivesEveryLivingBusItsOwnPort) {
  const TestBus a, b, c;
  EXPECT_EQ(std::set<std::string>({a.url(), b.url(), c.url()}).size(), 3u);
  EXPECT_EQ(a.url().find("7667"), std::string::npos);
}

}  // namespace
}  // namespace armcmc::test
