#include "support/process.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <stdexcept>

#include "support/paths.hpp"

namespace armcmc::test::process_test {
namespace {

using namespace std::chrono_literals;

TEST(Process, GivesCodeAndOutput) {
  const Outcome o = RunProgram("/bin/sh", {"-c", "echo good; echo bad >&2; exit 3"});
  EXPECT_EQ(o.code, 3);
  EXPECT_EQ(o.out, "good\n");
  EXPECT_EQ(o.err, "bad\n");
}

TEST(Process, TellsASignalFromACode) {
  Process p("/bin/sh", {"-c", "sleep 60"});
  EXPECT_TRUE(p.running());
  p.Signal(SIGKILL);
  const Process::Exit exit = p.Wait(10s);
  EXPECT_EQ(exit.signal, SIGKILL);
  EXPECT_EQ(exit.code, -1);
  EXPECT_FALSE(exit.timed_out);
}

TEST(Process, KillsWhatTakesTooLong) {
  Process p("/bin/sh", {"-c", "exec sleep 60"});
  EXPECT_TRUE(p.Wait(20ms).timed_out);
  EXPECT_FALSE(p.running());
}

TEST(Process, WaitsForWords) {
  Process p("/bin/sh", {"-c", "echo ready >&2; exec sleep 60"});
  EXPECT_TRUE(p.WaitForErr("ready", 10s));
  Process quiet("/bin/sh", {"-c", "exit 0"});
  EXPECT_FALSE(quiet.WaitForErr("ready", 10s));
}

TEST(Process, StartsInTheFolderThatItIsGiven) {
  const ScratchDir dir;
  const Outcome o = RunProgram("/bin/sh", {"-c", "echo here > found"}, 10s, dir.path());
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_TRUE(std::filesystem::exists(dir / "found"));
}

TEST(Process, WhatCannotBeStartedIsAnError) {
  EXPECT_THROW(Process("/no/such/program", {}), std::runtime_error);
  EXPECT_THROW(Process("/bin/sh", {"-c", "exit 0"}, "/no/such/folder"), std::runtime_error);
}

}  // namespace
}  // namespace armcmc::test::process_test
