#include "rt_config.hpp"

#include <gtest/gtest.h>

#include <string>

#include "armcmc/support/estimator_config.hpp"
#include "support/paths.hpp"

namespace armcmc::app::rt_config_test {
namespace {

using support::ConfigError;
using support::StrictTable;

rt::RtSettings Read(const std::string& text) {
  StrictTable root = StrictTable::FromText(text, "test.toml");
  const rt::RtSettings settings = ReadRtSettings(root);
  root.Finish();
  return settings;
}

std::string Complaint(const std::string& text) {
  try {
    (void)Read(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ReadRtSettings, DerivesDeadlineAndBudgetFromThePeriod) {
  const rt::RtSettings settings = Read("[timing]\nperiod_ms = 10\n");
  EXPECT_EQ(settings.deadline_ns, 10'000'000);
  EXPECT_EQ(settings.adjust_budget_ns, 8'000'000);
}

TEST(ReadRtSettings, ReadsEveryKey) {
  const rt::RtSettings s = Read(
      "[timing]\nperiod_ms = 1\ndeadline_ms = 2.5\nadjust_budget_ms = 0.75\n"
      "[rt]\nmode = \"enforce\"\nlock_memory = false\ncpu_idle = \"sleep\"\n"
      "[rt.collect]\npriority = 61\ncpu = 2\n[rt.adjust]\npriority = 62\ncpu = 3\n[rt.execute]\npriority = 63\ncpu = "
      "4\n"
      "[rt.publish]\npriority = 20\ncpu = 5\n[rt.witness]\npriority = 64\n[rt.watchdog]\non_hang = \"exit\"\n"
      "[lcm]\nurl = \"udpm://239.255.76.67:7700?ttl=1\"\nprefix = \"A_\"\n");
  EXPECT_EQ(s.period_ns, 1'000'000);
  EXPECT_EQ(s.deadline_ns, 2'500'000);
  EXPECT_EQ(s.adjust_budget_ns, 750'000);
  EXPECT_EQ(s.mode, rt::RtMode::kEnforce);
  EXPECT_FALSE(s.lock_memory);
  EXPECT_EQ(s.cpu_idle, rt::CpuIdle::kSleep);
  EXPECT_EQ(Read("[rt]\ncpu_idle = \"awake\"\n").cpu_idle, rt::CpuIdle::kAwake);
  EXPECT_EQ(Read("").cpu_idle, rt::CpuIdle::kAuto);
  EXPECT_EQ(s.collect.priority, 61);
  EXPECT_EQ(s.collect.cpu, 2);
  EXPECT_EQ(s.adjust.priority, 62);
  EXPECT_EQ(s.adjust.cpu, 3);
  EXPECT_EQ(s.execute.priority, 63);
  EXPECT_EQ(s.execute.cpu, 4);
  EXPECT_EQ(s.publish.priority, 20);
  EXPECT_EQ(s.publish.cpu, 5);
  EXPECT_EQ(s.witness_priority, 64);
  EXPECT_EQ(s.on_hang, rt::OnHang::kExit);
  EXPECT_EQ(s.lcm_url, "udpm://239.255.76.67:7700?ttl=1");
  EXPECT_EQ(s.prefix, "A_");
}

TEST(ReadRtSettings, NamesLineKeyAndRangeOfAMistake) {
  const std::string period = Complaint("[timing]\nperiod_ms = 0\n");
  EXPECT_NE(period.find("test.toml:2"), std::string::npos) << period;
  EXPECT_NE(period.find("period_ms"), std::string::npos) << period;
  EXPECT_NE(Complaint("[timing]\nperiod = 1\n").find("period_ms"), std::string::npos) << "the nearest known key";
  EXPECT_NE(Complaint("[rt]\nmode = \"hard\"\n").find("best_effort"), std::string::npos);
  EXPECT_NE(Complaint("[lcm]\nurl = \"tcpq://\"\n").find("udpm://"), std::string::npos);
  EXPECT_NE(Complaint("[rt.witness]\npriority = 10\n").find("rt.witness.priority"), std::string::npos);
  EXPECT_NE(Complaint("[timing]\ndeadline_ms = 50\nadjust_budget_ms = 50\n").find("adjust_budget_ms"),
            std::string::npos);
}

TEST(ReadInjections, ReadsAPlanAndNamesTheKeyOfAMistake) {
  StrictTable none = StrictTable::FromText("", "test.toml");
  EXPECT_TRUE(ReadInjections(none).empty());
  StrictTable root = StrictTable::FromText("[inject]\nplan = \"hang_adjust@7:30,squeeze@9\"\n", "test.toml");
  const auto plan = ReadInjections(root);
  root.Finish();
  ASSERT_EQ(plan.size(), 2U);
  EXPECT_EQ(plan[0].kind, rt::InjectionKind::kHangAdjust);
  EXPECT_EQ(plan[0].pack, 7);
  EXPECT_EQ(plan[0].amount, 30);
  StrictTable wrong = StrictTable::FromText("[inject]\nplan = \"explode@1\"\n", "test.toml");
  EXPECT_THROW((void)ReadInjections(wrong), ConfigError);
}

TEST(ReadGapLogSettings, ReadsEveryKeyAndRefusesOthers) {
  const auto read = [](const std::string& text) {
    StrictTable root = StrictTable::FromText(text, "test.toml");
    const GapLogSettings settings = ReadGapLogSettings(root);
    root.Finish();
    return settings;
  };
  const GapLogSettings s = read("[gap_log]\ndirectory = \"there\"\nwindow_s = 12.5\nafter_s = 0\nmax_files = 3\n");
  EXPECT_EQ(s.directory, "there");
  EXPECT_EQ(s.window_s, 12.5);
  EXPECT_EQ(s.after_s, 0.0);
  EXPECT_EQ(s.max_files, 3);
  for (const char* wrong : {"window_s = 0", "after_s = -1", "max_files = 0", "window = 3", "directory = 3"})
    EXPECT_THROW((void)read(std::string("[gap_log]\n") + wrong + "\n"), ConfigError) << wrong;
}

class ShippedConfig : public ::testing::TestWithParam<const char*> {};

TEST_P(ShippedConfig, IsReadCompletelyAndNamesItsModel) {
  const auto path = armcmc::test::SourceDir() / "rt" / "config" / (std::string(GetParam()) + ".toml");
  StrictTable root = StrictTable::FromFile(path);
  const EstimatorSettings estimator = support::ReadEstimatorSettings(root, "");
  const rt::RtSettings settings = ReadRtSettings(root);
  const GapLogSettings gap_log = ReadGapLogSettings(root);
  EXPECT_NO_THROW(root.Finish());
  EXPECT_EQ(gap_log.directory, GapLogSettings{}.directory);
  EXPECT_EQ(gap_log.window_s, GapLogSettings{}.window_s);
  EXPECT_EQ(gap_log.after_s, GapLogSettings{}.after_s);
  EXPECT_EQ(gap_log.max_files, GapLogSettings{}.max_files);
  EXPECT_EQ(estimator.gap_watch.tolerance, BuiltinSettings(GetParam()).gap_watch.tolerance);
  EXPECT_TRUE(estimator.gap_watch.enabled);
  EXPECT_NO_THROW(estimator.Validate());
  EXPECT_EQ(settings.period_ns, 100'000'000);
  EXPECT_EQ(settings.deadline_ns, 100'000'000);
  EXPECT_EQ(settings.adjust_budget_ns, 80'000'000);
}

INSTANTIATE_TEST_SUITE_P(All, ShippedConfig,
                         ::testing::Values("hunt_crossley", "soft_actuator", "soft_actuator_excited"),
                         [](const auto& at) { return std::string(at.param); });

TEST(OverlappingConfig, AHundredHertzAndAThousandAreReadCompletely) {
  const struct {
    const char* name;
    Nanos period_ns;
    int overlap;
  } kShipped[] = {{"hunt_crossley_100hz", 10'000'000, 10}, {"hunt_crossley_1khz", 1'000'000, 100}};
  for (const auto& shipped : kShipped) {
    const auto path = armcmc::test::SourceDir() / "rt" / "config" / (std::string(shipped.name) + ".toml");
    StrictTable root = StrictTable::FromFile(path);
    const EstimatorSettings estimator = support::ReadEstimatorSettings(root, "");
    const rt::RtSettings settings = ReadRtSettings(root);
    EXPECT_NO_THROW(root.Finish()) << shipped.name;
    EXPECT_EQ(estimator.overlap, shipped.overlap);
    EXPECT_EQ(settings.period_ns, shipped.period_ns);
    EXPECT_EQ(settings.deadline_ns, shipped.period_ns) << "one at a time, none waits for the one before";
    EXPECT_LT(settings.adjust_budget_ns, settings.deadline_ns);
  }
}

}  // namespace
}  // namespace armcmc::app::rt_config_test
