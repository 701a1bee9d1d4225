#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "armcmc/plant_sim/effects/effect.hpp"
#include "armcmc/plant_sim/latency_histogram.hpp"
#include "armcmc/plant_sim/log_ring.hpp"
#include "armcmc/plant_sim/pack_builder.hpp"
#include "armcmc/plant_sim/pack_sender.hpp"
#include "builtin_scenario.hpp"
#include "support/alloc_counter.hpp"

namespace armcmc::plant_sim::no_allocation_test {
namespace {

class PublishingPath : public testing::TestWithParam<const char*> {};

TEST_P(PublishingPath, DoesNotAllocate) {
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  LogRing ring(512);
  PackSender sender("", FaultPlan::Parse("nan@3,size@4,duplicate@5,reorder@6,drop@8,foreign@9,garbage@10"), &ring);
  PackBuilder builder(BuiltinScenario(GetParam()), 1, 1);
  LatencyHistogram histogram;
  bool finite = true;
  long allocations = 0;
  {
    test::AllocCounter guard;
    for (int k = 1; k <= 100; ++k) {
      finite = builder.Next() && finite;
      builder.Stamp(k, k);
      sender.Send(builder.pack(), builder.truth());
      histogram.Add(k);
    }
    sender.Flush();
    allocations = guard.count();
  }
  EXPECT_TRUE(finite);
  EXPECT_EQ(ring.lost(), 0);
  EXPECT_EQ(allocations, 0);
}

INSTANTIATE_TEST_SUITE_P(Scenarios, PublishingPath,
                         testing::Values("hunt_crossley_paper", "hunt_crossley_drift", "soft_actuator_paper",
                                         "soft_actuator_excited", "contact_rich", "experiment_closed_valve_hold",
                                         "experiment_u_triangle", "experiment_fast_and_slow_fills"),
                         [](const auto& at) { return std::string(at.param); });

TEST(HiddenEffects, DoNotAllocateOnThePublishingPath) {
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  for (const char* name : {"hunt_crossley_paper", "soft_actuator_excited"}) {
    Scenario scenario = BuiltinScenario(name);
    for (const EffectSpec& spec : EffectRegistry(*scenario.family)) {
      std::vector<double> values;
      for (const EffectParameter& parameter : spec.parameters) values.push_back(0.05 * parameter.hi);
      scenario.hidden = {HiddenEffect{&spec, values, Gate{}, 0.0}};
      PackBuilder builder(scenario, 1, 1);
      bool finite = true;
      long allocations = 0;
      {
        test::AllocCounter guard;
        for (int k = 0; k < 20; ++k) finite = builder.Next() && finite;
        allocations = guard.count();
      }
      EXPECT_TRUE(finite) << spec.name;
      EXPECT_EQ(allocations, 0) << spec.name;
    }
  }
}

}  // namespace
}  // namespace armcmc::plant_sim::no_allocation_test
