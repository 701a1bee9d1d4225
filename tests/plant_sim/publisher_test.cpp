#include "armcmc/plant_sim/publisher.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "armcmc/plant_sim/monotonic_clock.hpp"
#include "builtin_scenario.hpp"
#include "recording_sink.hpp"

namespace armcmc::plant_sim::publisher_test {
namespace {

Scenario Fast(double duration_s) {
  Scenario scenario = BuiltinScenario("hunt_crossley_paper");
  scenario.pack_samples = 1;  // 1 kHz
  scenario.duration_s = duration_s;
  return scenario;
}

TEST(Publisher, SendsEveryPackOnceInOrderOnAnExactGrid) {
  RecordingSink bus;
  LogRing log(2048);
  Publisher publisher(Fast(0.3), 1, 9, "", FaultPlan(), &bus, &log);
  const std::int64_t start_ns = MonotonicNow();
  publisher.Start(start_ns);
  publisher.Join();
  EXPECT_TRUE(publisher.finished());
  EXPECT_EQ(publisher.packs_sent(), 300);
  EXPECT_EQ(publisher.lateness().count(), 300);
  EXPECT_FALSE(publisher.diverged());
  std::vector<std::int64_t> expected(300);
  std::iota(expected.begin(), expected.end(), 1);
  EXPECT_EQ(bus.Seqs("PLANT_PACK"), expected);
  for (const RecordingSink::Message& message : bus.On("PLANT_PACK")) {
    data_pack_t pack{};
    ASSERT_GT(pack.decode(message.bytes.data(), 0, static_cast<int>(message.bytes.size())), 0);
    EXPECT_EQ(pack.t_last_ns, start_ns + pack.seq * 1'000'000);
  }
  int logged = 0;
  for (; log.Front() != nullptr; ++logged) log.Pop();
  EXPECT_EQ(logged, 600);
}

TEST(Publisher, NeverSendsBeforeThePackIsDue) {
  class Clocked final : public MessageSink {
   public:
    bool Send(const char*, const void* data, int size, std::int64_t) noexcept override {
      data_pack_t pack{};
      if (pack.decode(data, 0, size) > 0 && MonotonicNow() < pack.t_last_ns) early_ = true;
      return true;
    }
    bool early_ = false;
  } bus;
  Publisher publisher(Fast(0.05), 1, 9, "", FaultPlan(), &bus, nullptr);
  publisher.Start(MonotonicNow() + 1'000'000);
  publisher.Join();
  EXPECT_FALSE(bus.early_);
}

TEST(Publisher, AWantedDelayIsNotThePlantsOwnLateness) {
  Scenario scenario = Fast(0.02);
  scenario.sample_interval_s = 0.01;  // two packs
  RecordingSink bus;
  Publisher publisher(scenario, 1, 9, "", FaultPlan::Parse("late@1:60"), &bus, nullptr);
  const std::int64_t start_ns = MonotonicNow();
  publisher.Start(start_ns);
  publisher.Join();
  EXPECT_GE(MonotonicNow() - start_ns, 70'000'000);
  EXPECT_LE(publisher.lateness().max_ms() * 1e6, static_cast<double>(MonotonicNow() - start_ns - 70'000'000));
}

TEST(Publisher, StopsWhenAsked) {
  RecordingSink bus;
  Scenario scenario = BuiltinScenario("hunt_crossley_paper");
  Publisher publisher(scenario, 1, 9, "", FaultPlan(), &bus, nullptr);
  publisher.Start(MonotonicNow());
  publisher.RequestStop();
  publisher.Join();
  EXPECT_TRUE(publisher.finished());
  EXPECT_LT(publisher.packs_sent(), scenario.num_packs());
}

}  // namespace
}  // namespace armcmc::plant_sim::publisher_test
