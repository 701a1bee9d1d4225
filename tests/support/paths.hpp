#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace armcmc::test {

/// Root of the source tree.
[[nodiscard]] std::filesystem::path SourceDir();

/// Path of a program of this build. It may not exist when its part is switched off.
[[nodiscard]] std::filesystem::path Program(const std::string& name);

/// A recording, for example "paper/hunt_crossley.csv": under $ARMCMC_DATA when set, else under the folder that
/// was configured (ARMCMC_TEST_DATA). Nothing when it is not there.
[[nodiscard]] std::optional<std::filesystem::path> FindData(const std::string& relative);

/// Why a test that needs `relative` is skipped: where it was looked for and what to set.
[[nodiscard]] std::string DataSkipReason(const std::string& relative);

/// A fresh folder for one test, removed with everything in it at the end of its life.
class ScratchDir {
 public:
  ScratchDir();
  ~ScratchDir();
  ScratchDir(const ScratchDir&) = delete;
  ScratchDir& operator=(const ScratchDir&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// An LCM URL of this test alone: LCM 1.3.1 tells buses apart by their port only, so that two tests that run
/// beside each other must not share one. Never the default port. The port is reserved machine-wide, by an
/// abstract socket that lives as long as this object, against other test processes.
class TestBus {
 public:
  /// @throws std::runtime_error when no port is free.
  TestBus();
  ~TestBus();
  TestBus(const TestBus&) = delete;
  TestBus& operator=(const TestBus&) = delete;
  [[nodiscard]] const std::string& url() const { return url_; }

 private:
  int lock_fd_ = -1;
  std::string url_;
};

/// True when multicast has a route: without one no LCM bus can be made.
[[nodiscard]] bool MulticastWorks();
[[nodiscard]] std::string MulticastSkipReason();

}  // namespace armcmc::test

/// Skips the running test when a recording is missing.
#define ARMCMC_REQUIRE_DATA(relative)                                                                  \
  do {                                                                                                 \
    if (!::armcmc::test::FindData(relative)) GTEST_SKIP() << ::armcmc::test::DataSkipReason(relative); \
  } while (false)

/// Skips the running test on a machine without multicast.
#define ARMCMC_REQUIRE_MULTICAST()                                                                \
  do {                                                                                            \
    if (!::armcmc::test::MulticastWorks()) GTEST_SKIP() << ::armcmc::test::MulticastSkipReason(); \
  } while (false)
