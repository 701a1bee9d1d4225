#include "armcmc/support/shared_files.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "armcmc/support/strict_toml.hpp"
#include "support/paths.hpp"

namespace armcmc::support::shared_files_test {
namespace {

TEST(SharedFiles, APathIsTakenAsItIs) {
  const test::ScratchDir dir;
  std::ofstream(dir / "own.toml") << "x = 1\n";
  EXPECT_EQ(FindSharedFile("config", dir / "own.toml"), dir / "own.toml");
  EXPECT_EQ(FindSharedFile("config", dir / "own"), dir / "own.toml");
}

TEST(SharedFiles, ANameIsFoundBesideTheProgram) {
  // The folder of this test program, with a kind of its own.
  const auto shared =
      std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / "share/armcmc/test-kind";
  std::filesystem::create_directories(shared);
  std::ofstream(shared / "alpha.toml") << "";
  std::ofstream(shared / "beta.toml") << "";
  std::ofstream(shared / "notes.txt") << "";
  EXPECT_EQ(FindSharedFile("test-kind", "alpha"), shared / "alpha.toml");
  EXPECT_EQ(FindSharedFile("test-kind", "beta.toml"), shared / "beta.toml");
  EXPECT_EQ(SharedFileNames("test-kind"), (std::vector<std::string>{"alpha", "beta"}));
  EXPECT_TRUE(SharedFileNames("no-such-kind").empty());
  try {
    static_cast<void>(FindSharedFile("test-kind", "alpa"));
    ADD_FAILURE() << "a file that is not there was found";
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("did you mean alpha?"), std::string::npos) << message;
    EXPECT_NE(message.find("available: alpha, beta"), std::string::npos) << message;
  }
  std::filesystem::remove_all(shared);
}

TEST(SharedFiles, AFolderIsNoFile) {
  const test::ScratchDir dir;
  EXPECT_THROW(static_cast<void>(FindSharedFile("config", dir.path())), ConfigError);
}

}  // namespace
}  // namespace armcmc::support::shared_files_test
