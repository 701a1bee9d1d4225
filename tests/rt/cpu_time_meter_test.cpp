#include "armcmc/rt/cpu_time_meter.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <cstdint>
#include <thread>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/process_setup.hpp"
#include "test_threads.hpp"

namespace armcmc::rt::cpu_time_meter_test {
namespace {

using test::PinTo;
using test::WorkFor;

std::int64_t NumSleeps() {
  rusage usage{};
  EXPECT_EQ(getrusage(RUSAGE_THREAD, &usage), 0);
  return usage.ru_nvcsw;
}

TEST(CpuTimeMeter, WithoutTheRightToTheCpuNothingIsWithheld) {
  CpuTimeMeter meter;
  const Nanos start_ns = meter.Start();
  WorkFor(kNanosPerMilli);
  EXPECT_EQ(meter.End(start_ns + kNanosPerSecond), 0);
}

TEST(CpuTimeMeter, WhatAThreadDidNotGetWasWithheld) {
  CpuTimeMeter meter;
  meter.SetTrusted(true);
  const Nanos start_ns = meter.Start();
  const Nanos used_ns = ThreadCpuTime();
  WorkFor(kNanosPerMilli);
  const Nanos withheld_ns = meter.End(start_ns + kNanosPerSecond);  // had it been a second
  EXPECT_LE(withheld_ns, kNanosPerSecond - kNanosPerMilli);
  EXPECT_GE(withheld_ns, kNanosPerSecond - (ThreadCpuTime() - used_ns) - kNanosPerMilli);
}

TEST(CpuTimeMeter, WhoSleepsHasNothingWithheld) {
  CpuTimeMeter meter;
  meter.SetTrusted(true);
  meter.Start();
  SleepUntil(MonotonicNow() + 5 * kNanosPerMilli);
  EXPECT_EQ(meter.End(MonotonicNow()), 0);
  const Nanos start_ns = meter.Start();
  EXPECT_GT(meter.End(start_ns + kNanosPerSecond), 0) << "the sleep before it does not matter";
}

TEST(CpuTimeMeter, WhoIsToldOfWorkWantsTheCpu) {
  constexpr Nanos kMs = kNanosPerMilli;
  CpuTimeMeter meter;
  meter.SetTrusted(true);
  std::atomic<Nanos> stage_ns{0}, witness_ns{0};
  meter.AddOther(&stage_ns, /*goes_first=*/true);
  meter.AddOther(&witness_ns, /*goes_first=*/false);
  (void)meter.End(meter.Start());
  const Nanos begin_ns = MonotonicNow();
  const auto after = [&](Nanos wait_ns) { return meter.WithheldWaiting(begin_ns + wait_ns); };
  EXPECT_EQ(after(kNanosPerSecond), 0) << "nobody told it";
  meter.NoteWoken(begin_ns);
  EXPECT_LE(after(kNanosPerSecond), kNanosPerSecond - kMs / 10) << "an ordinary wake-up is none";
  EXPECT_GE(after(kNanosPerSecond), kNanosPerSecond - 100 * kMs);
  EXPECT_EQ(after(kMs / 20), 0);
  witness_ns = 400 * kMs;
  EXPECT_GE(after(kNanosPerSecond), kNanosPerSecond - 100 * kMs) << "in many short turns";
  stage_ns = 400 * kMs;
  EXPECT_LE(after(kNanosPerSecond), 600 * kMs) << "a stage above had the CPU";
  meter.NoteWoken(begin_ns - kNanosPerSecond);
  EXPECT_LE(after(kNanosPerSecond), 600 * kMs) << "told while it still did the work before";
  meter.SetTrusted(false);
  EXPECT_EQ(after(kNanosPerSecond), 0);
}

TEST(CpuTimeMeter, AThreadOfOursIsNotTheMachine) {
  const int cpu = AvailableCpus().front();
  std::atomic<Nanos> rival_used_ns{0};
  std::atomic<bool> stop{false};
  std::thread rival([&] {
    PinTo(cpu);
    while (!stop.load()) rival_used_ns.store(ThreadCpuTime());
  });
  std::thread worker([&] {
    PinTo(cpu);
    CpuTimeMeter blind, knowing;
    blind.SetTrusted(true);
    knowing.SetTrusted(true);
    knowing.AddOther(&rival_used_ns, /*goes_first=*/true);
    while (rival_used_ns.load() == 0) std::this_thread::yield();
    Nanos rival_had_ns = 0, by_blind = 0, by_knowing = 0;
    std::int64_t sleeps = 1;
    for (int attempt = 0; attempt < 10 && sleeps != 0; ++attempt) {  // a page fault may wait: then nothing is reported
      sleeps = -NumSleeps();
      blind.Start();
      knowing.Start();
      const Nanos rival_before_ns = rival_used_ns.load();  // in between: the CPU may change hands at every line
      WorkFor(50 * kNanosPerMilli);
      rival_had_ns = rival_used_ns.load() - rival_before_ns;
      const Nanos end_ns = MonotonicNow();
      by_blind = blind.End(end_ns);
      by_knowing = knowing.End(end_ns);
      sleeps += NumSleeps();
    }
    EXPECT_GT(rival_had_ns, 10 * kNanosPerMilli) << "two ordinary threads share a CPU";
    EXPECT_GE(by_blind, rival_had_ns - 2 * kNanosPerMilli);
    EXPECT_LE(by_knowing, by_blind - rival_had_ns + 2 * kNanosPerMilli);
  });
  worker.join();
  stop.store(true);
  rival.join();
}

}  // namespace
}  // namespace armcmc::rt::cpu_time_meter_test
