#include "armcmc/support/subprocess.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace armcmc::support::subprocess_test {
namespace {

const std::filesystem::path kHere = "/tmp";

TEST(Subprocess, GivesTheExitCodeAndWhatWasComplained) {
  const SubprocessEnd end = RunSubprocess("/bin/sh", {"-c", "echo lost; echo kept >&2; exit 7"}, kHere);
  EXPECT_EQ(end.code, 7);
  EXPECT_EQ(end.errors, "kept\n");
}

TEST(Subprocess, RunsInTheFolderWithItsArgumentsAsTheyAre) {
  const SubprocessEnd end = RunSubprocess("/bin/sh", {"-c", "pwd >&2; printf '%s' \"$1\" >&2", "sh", "a 'b' $c"}, "/");
  EXPECT_EQ(end.errors, "/\na 'b' $c");
}

TEST(Subprocess, ReadsNothing) { EXPECT_EQ(RunSubprocess("/bin/cat", {}, kHere).code, 0); }

TEST(Subprocess, ASignalIsNegative) { EXPECT_EQ(RunSubprocess("/bin/sh", {"-c", "kill -9 $$"}, kHere).code, -9); }

TEST(Subprocess, KeepsMoreThanAPipeHolds) {
  const SubprocessEnd end = RunSubprocess("/bin/sh", {"-c", "head -c 300000 /dev/zero >&2"}, kHere);
  EXPECT_EQ(end.errors.size(), 300000u);
}

TEST(Subprocess, WhatCannotBeStartedIsAnErrorWithItsName) {
  try {
    (void)RunSubprocess("/no/such/program", {}, kHere);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/no/such/program"), std::string::npos) << error.what();
  }
}

TEST(Subprocess, SeveralAtOnceEndEachByItself) {
  std::vector<int> codes(8, -1);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < codes.size(); ++i)
    threads.emplace_back([&codes, i] {
      codes[i] = RunSubprocess("/bin/sh", {"-c", "exit " + std::to_string(i)}, kHere).code;
    });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < codes.size(); ++i) EXPECT_EQ(codes[i], static_cast<int>(i));
}

TEST(SiblingProgram, IsInTheFolderOfThisOne) {
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
  EXPECT_EQ(SiblingProgram(self.filename().string()), self);
}

}  // namespace
}  // namespace armcmc::support::subprocess_test
