#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>

#include "integration/live_pair.hpp"

namespace armcmc::test::hang_test {
namespace {

using namespace std::chrono_literals;

class Hang : public LivePair {
 protected:
  /// Starts it with the shipped configuration and more behind it.
  std::unique_ptr<Process> StartEstimatorWith(const std::string& more) {
    UseConfig(ShippedConfig() + more);
    return StartEstimator();
  }
};

TEST_F(Hang, IsFlaggedAndSurvived) {
  auto estimator = StartEstimatorWith("[inject]\nplan = \"hang_adjust@5:400\"\n");
  auto plant = StartPlant("1.6");
  ASSERT_EQ(plant->Wait(60s).code, 0) << plant->err();
  EXPECT_TRUE(estimator->WaitForErr("stage adjust hangs", 5s)) << estimator->err();
  ASSERT_TRUE(recorder_->WaitUntil([this] { return recorder_->estimates().back().seq == 16; })) << estimator->err();
  bool flagged = false;
  for (const estimator_status_t& status : recorder_->statuses()) {
    flagged = flagged || (status.fault_flags & estimator_status_t::FAULT_STAGE_HUNG) != 0;
    EXPECT_NE(status.degraded_flags & estimator_status_t::DEGRADED_INJECTED, 0) << "it always says that it is a test";
  }
  EXPECT_TRUE(flagged);
  const Json report = Finish(estimator.get());
  EXPECT_GE(report["hangs"], 1);
  EXPECT_GE(report["packs"]["dropped"], 2) << "the newest data win";
  EXPECT_EQ(report["injected"]["hang_adjust"], 1);
}

TEST_F(Hang, EndsTheProcessWhereTheConfigurationSaysSo) {
  auto estimator = StartEstimatorWith("[rt.watchdog]\non_hang = \"exit\"\n[inject]\nplan = \"hang_execute@5:30000\"\n");
  auto plant = StartPlant("2");
  const Process::Exit exit = estimator->Wait(20s);
  EXPECT_EQ(exit.code, 1) << estimator->err();
  EXPECT_NE(estimator->err().find("on_hang"), std::string::npos);
}

TEST_F(Hang, TheServiceManagerHearsNothingWhileAStageHangs) {
  const std::string path = dir_ / "notify";
  const int manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), path.size());
  ASSERT_EQ(bind(manager, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  setenv("NOTIFY_SOCKET", path.c_str(), 1);
  setenv("WATCHDOG_USEC", "150000", 1);  // a sign of life every 50 ms
  auto estimator = StartEstimatorWith("[inject]\nplan = \"hang_adjust@5:30000\"\n");
  unsetenv("NOTIFY_SOCKET");
  unsetenv("WATCHDOG_USEC");
  const auto heard = [manager] {
    std::string all;
    char text[256];
    for (ssize_t n = 0; (n = recv(manager, text, sizeof text, 0)) > 0;) {
      all += std::string(text, static_cast<std::size_t>(n)) + "\n";
    }
    return all;
  };
  std::string alive;
  EXPECT_TRUE(recorder_->WaitUntil([&] {
    alive += heard();
    return alive.find("READY=1") != std::string::npos && alive.find("WATCHDOG=1") != std::string::npos;
  })) << alive;

  auto plant = StartPlant("2");
  ASSERT_TRUE(estimator->WaitForErr("stage adjust hangs", 20s)) << estimator->err();
  std::this_thread::sleep_for(100ms);  // one turn of the loop that tells the manager
  (void)heard();
  std::this_thread::sleep_for(300ms);
  EXPECT_EQ(heard().find("WATCHDOG=1"), std::string::npos) << "a stage hangs: no sign of life";
  close(manager);
}

}  // namespace
}  // namespace armcmc::test::hang_test
