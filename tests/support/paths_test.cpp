#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <set>
#include <string>

#include "support/paths.hpp"

namespace armcmc::test::paths_test {
namespace {

/// Sets a variable of the environment for the length of a test: others of this program read it, too.
class EnvironmentVariable {
 public:
  EnvironmentVariable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  ~EnvironmentVariable() {
    if (before_)
      setenv(name_, before_->c_str(), 1);
    else
      unsetenv(name_);
  }
  EnvironmentVariable(const EnvironmentVariable&) = delete;
  EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(Paths, DataIsLookedForInTheFolderOfTheEnvironment) {
  const ScratchDir dir;
  std::ofstream(dir / "some.csv") << "t\n";
  const EnvironmentVariable data("ARMCMC_DATA", dir.path().string());
  EXPECT_EQ(FindData("some.csv"), dir / "some.csv");
  EXPECT_FALSE(FindData("absent.csv").has_value());
  EXPECT_NE(DataSkipReason("absent.csv").find((dir / "absent.csv").string()), std::string::npos);
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
}  // namespace armcmc::test::paths_test
