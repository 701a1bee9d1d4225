#include "armcmc/rt/cpu_wake_request.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "armcmc/rt/settings.hpp"
#include "support/paths.hpp"

namespace armcmc::rt::cpu_wake_request_test {
namespace {

TEST(CpuWakeRequest, AsksForABoundOfZeroMicroseconds) {
  const armcmc::test::ScratchDir dir;
  const std::filesystem::path device = dir / "device";
  std::ofstream(device) << "as it was before";
  CpuWakeRequest request;
  EXPECT_FALSE(request.held());
  ASSERT_TRUE(request.Hold(device.c_str()));
  EXPECT_TRUE(request.held());
  std::ifstream file(device, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  EXPECT_EQ(text.substr(0, 4), std::string(4, '\0')) << "an int32, as the kernel reads it";
}

TEST(CpuWakeRequest, SaysWhyWhereItIsNotGranted) {
  CpuWakeRequest request;
  EXPECT_FALSE(request.Hold("/nowhere/cpu_dma_latency"));
  EXPECT_EQ(errno, ENOENT);
  EXPECT_FALSE(request.Hold("/dev/full"));
  EXPECT_EQ(errno, ENOSPC) << "that of the write, not of the close";
  EXPECT_FALSE(request.held());
}

TEST(RtSettings, KeepsTheCpusAwakeForShortPeriodsUnlessToldOtherwise) {
  RtSettings settings;
  EXPECT_FALSE(settings.KeepsCpusAwake());
  settings.period_ns = RtSettings::kAwakeBelowNs;
  EXPECT_FALSE(settings.KeepsCpusAwake());
  settings.period_ns = RtSettings::kAwakeBelowNs - 1;
  EXPECT_TRUE(settings.KeepsCpusAwake());
  settings.cpu_idle = CpuIdle::kSleep;
  EXPECT_FALSE(settings.KeepsCpusAwake());
  settings.period_ns = 100'000'000;
  settings.cpu_idle = CpuIdle::kAwake;
  EXPECT_TRUE(settings.KeepsCpusAwake());
}

}  // namespace
}  // namespace armcmc::rt::cpu_wake_request_test
