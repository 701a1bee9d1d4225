#include "armcmc/rt/settings.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>

namespace armcmc::rt::settings_test {
namespace {

TEST(RtSettings, NamesTheKeyThatIsWrong) {
  const auto complaint = [](const std::function<void(RtSettings*)>& change) -> std::string {
    RtSettings settings;
    change(&settings);
    try {
      settings.Validate();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto names = [](const std::string& text, const char* key) { return text.find(key) != std::string::npos; };
  EXPECT_TRUE(names(complaint([](auto* s) { s->period_ns = 1000; }), "timing.period_ms = 0.001"));
  EXPECT_TRUE(names(complaint([](auto* s) { s->deadline_ns = 0; }), "timing.deadline_ms = 0"));
  EXPECT_TRUE(names(complaint([](auto* s) { s->deadline_ns = 11 * s->period_ns; }), "timing.deadline_ms"));
  EXPECT_TRUE(names(complaint([](auto* s) { s->adjust_budget_ns = s->deadline_ns; }), "timing.adjust_budget_ms = 100"));
  EXPECT_TRUE(names(complaint([](auto* s) { s->collect.priority = 0; }), "rt.collect.priority = 0"));
  EXPECT_TRUE(names(complaint([](auto* s) { s->adjust.cpu = -1; }), "rt.adjust.cpu = -1"));
  EXPECT_TRUE(names(complaint([](auto* s) { s->publish.priority = 75; }), "rt.publish.priority = 75"));
  EXPECT_TRUE(names(complaint([](auto* s) { s->witness_priority = 80; }), "rt.witness.priority = 80"));
  EXPECT_TRUE(names(complaint([](auto* s) { s->prefix = std::string(60, 'x'); }), "lcm.prefix"));
  EXPECT_TRUE(names(complaint([](auto* s) { s->lcm_url = "memq://"; }), "LCM URL"));
}

TEST(RtSettings, LeavesExecuteAReserve) {
  RtSettings settings;
  EXPECT_EQ(settings.ExecuteReserveNs(), 20'000'000);
  settings.adjust_budget_ns = 95'000'000;
  EXPECT_EQ(settings.ExecuteReserveNs(), 5'000'000);
}

}  // namespace
}  // namespace armcmc::rt::settings_test
