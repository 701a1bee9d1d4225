#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <thread>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/pipeline.hpp"
#include "armcmc/rt/process_setup.hpp"
#include "fake_engine.hpp"
#include "support/paths.hpp"
#include "test_bus.hpp"
#include "test_packs.hpp"
#include "test_threads.hpp"

namespace armcmc::rt::stolen_cpu_test {
namespace {

/// Takes three quarters of a CPU like a hypervisor that is short of time: in slices shorter than a period of the
/// witness, above every thread of the pipeline.
void TakeInSlices(int cpu, Nanos until_ns) {
  test::PinTo(cpu);
  sched_param param{};
  param.sched_priority = 99;
  ASSERT_EQ(pthread_setschedparam(pthread_self(), SCHED_FIFO, &param), 0);
  while (MonotonicNow() < until_ns) {
    for (const Nanos episode_end = MonotonicNow() + 60 * kNanosPerMilli; MonotonicNow() < episode_end;) {
      for (const Nanos slice_end = MonotonicNow() + 300 * kNanosPerMicro; MonotonicNow() < slice_end;) {
      }
      SleepUntil(MonotonicNow() + 100 * kNanosPerMicro);
    }
    SleepUntil(MonotonicNow() + 200 * kNanosPerMilli);
  }
}

TEST(StolenCpu, WhatIsTakenInShortSlicesIsNotOurOwn) {
  ARMCMC_REQUIRE_MULTICAST();
  if (AvailableCpus().size() < 2) GTEST_SKIP() << "needs two CPUs: the thief takes one";
  const armcmc::test::TestBus bus;
  RtSettings settings;
  settings.lcm_url = bus.url();
  settings.lock_memory = false;
  settings.period_ns = settings.deadline_ns = 20 * kNanosPerMilli;
  settings.adjust_budget_ns = 15 * kNanosPerMilli;
  test::FakeEngine engine;
  engine.adjust_work_ns = 12 * kNanosPerMilli;
  Pipeline pipeline(settings, &engine, {});
  pipeline.Start();
  const ThreadPlacement adjust = pipeline.placements()[IndexOf(Stage::kAdjust)];
  if (!adjust.fifo || !adjust.pinned) GTEST_SKIP() << "needs the right to real-time priorities";

  test::Peer peer(bus.url());
  const Nanos end_ns = MonotonicNow() + 2 * kNanosPerSecond;
  std::thread thief([&] { TakeInSlices(adjust.cpu, end_ns); });
  // The first pack comes when the thief is at work: nothing is known yet of how long a step takes.
  Nanos due_ns = MonotonicNow() + 5 * kNanosPerMilli;
  for (std::int64_t seq = 1; due_ns < end_ns; ++seq, due_ns += settings.period_ns) {
    SleepUntil(due_ns);
    peer.Publish("PLANT_PACK", test::Encode(test::ValidPack(seq)));
  }
  thief.join();
  pipeline.RequestStop();
  pipeline.Join();
  const std::int64_t of_machine = pipeline.lane().monitor().misses(MissCause::kMachine);
  const std::int64_t own = pipeline.lane().monitor().misses(MissCause::kOwn);
  EXPECT_GE(of_machine, 4) << own << " own";
  // Without the CPU time of the stages more than half of them are taken for our own; two, if what was taken from the
  // first step counts as the time that a step usually needs.
  EXPECT_LE(20 * own, of_machine);
}

}  // namespace
}  // namespace armcmc::rt::stolen_cpu_test
