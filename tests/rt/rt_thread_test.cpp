#include "armcmc/rt/rt_thread.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>

#include "armcmc/rt/process_setup.hpp"
#include "test_threads.hpp"

namespace armcmc::rt::rt_thread_test {
namespace {

void Raise(void* flag) noexcept { static_cast<std::atomic<bool>*>(flag)->store(true); }

TEST(RtThread, RunsAndReportsWhatTheKernelSays) {
  std::atomic<bool> ran{false};
  RtThread thread;
  ThreadRequest request;
  request.name = "test";
  request.priority = 10;
  request.cpu = AvailableCpus().front();
  const ThreadPlacement& placement = thread.Start(request, RtMode::kBestEffort, &Raise, &ran);
  EXPECT_TRUE(placement.pinned);
  EXPECT_EQ(placement.cpu, request.cpu);
  EXPECT_EQ(placement.fifo, placement.priority == 10) << "either granted, or said not to be";
  thread.Join();
  EXPECT_TRUE(ran.load());
}

/// Works for 5 ms of CPU time between two notes: once as much as it likes to say, once no more than a short turn.
struct Turns {
  RtThread thread;
  Nanos long_turn_ns = 0, short_turn_ns = 0;

  static void Run(void* context) noexcept {
    auto& turns = *static_cast<Turns*>(context);
    turns.thread.NoteCpuTime();
    const Nanos first_ns = turns.Work();
    turns.thread.NoteCpuTime();
    const Nanos second_ns = turns.Work();
    turns.long_turn_ns = second_ns - first_ns;
    turns.thread.NoteCpuTime(RtThread::kShortTurnNs);
    turns.short_turn_ns = turns.thread.cpu_time_ns().load() - second_ns;
  }
  [[nodiscard]] Nanos Work() const noexcept {
    test::WorkFor(5'000'000);
    return thread.cpu_time_ns().load();
  }
};

TEST(RtThread, SaysHowMuchCpuTimeItHad) {
  Turns turns;
  EXPECT_EQ(turns.thread.cpu_time_ns().load(), 0);
  turns.thread.Start({"test", 0, -1}, RtMode::kBestEffort, &Turns::Run, &turns);
  turns.thread.Join();
  EXPECT_GE(turns.long_turn_ns, 5'000'000);
  EXPECT_EQ(turns.short_turn_ns, RtThread::kShortTurnNs) << "what is charged beyond that is a stall";
}

TEST(RtThread, RunsUnpinnedAndSaysSoWhenTheCpuDoesNotExist) {
  std::atomic<bool> ran{false};
  RtThread thread;
  ThreadRequest request;
  request.name = "test";
  request.priority = 10;
  request.cpu = 1000;
  const ThreadPlacement& placement = thread.Start(request, RtMode::kBestEffort, &Raise, &ran);
  EXPECT_FALSE(placement.pinned);
  thread.Join();
  EXPECT_TRUE(ran.load());
}

TEST(RtThread, RefusesToStartInEnforceModeAndNamesTheCpu) {
  std::atomic<bool> ran{false};
  RtThread thread;
  ThreadRequest request;
  request.name = "adjust";
  request.priority = 10;
  request.cpu = 1000;
  try {
    thread.Start(request, RtMode::kEnforce, &Raise, &ran);
    ADD_FAILURE() << "started";
  } catch (const PrivilegeError& error) {
    // Without the right to FIFO either one may be refused first.
    const std::string text = error.what();
    EXPECT_TRUE(text.find("CPU 1000") != std::string::npos || text.find("setcap") != std::string::npos) << text;
  }
  EXPECT_FALSE(ran.load());
}

TEST(PrivilegeRemedy, NamesEveryWay) {
  const std::string text = PrivilegeRemedy();
  for (const char* word :
       {"setcap", "cap_sys_nice", "cap_ipc_lock", "rtprio", "memlock", "ulimit -r -l", "best_effort"}) {
    EXPECT_NE(text.find(word), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace armcmc::rt::rt_thread_test
