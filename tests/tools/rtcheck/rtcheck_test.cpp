#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "armcmc/rtcheck/findings.hpp"
#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::rtcheck::rtcheck_test {
namespace {

/// A tree that looks like /proc and /sys of a well-set-up computer with four processors.
class RtCheck : public ::testing::Test {
 protected:
  RtCheck() {
    Put("proc/self/status", "Name:\tx\nCapEff:\t0000000000804000\n");  // SYS_NICE, IPC_LOCK
    Put("proc/self/limits", "Limit  Soft Limit  Hard Limit  Units\nMax locked memory  65536  65536  bytes\n");
    Put("proc/version", "Linux version 6.1.0-rt (gcc) #1 SMP PREEMPT_RT\n");
    Put("proc/sys/net/core/rmem_max", "4194304\n");
    Put("proc/sys/kernel/sched_rt_runtime_us", "-1\n");
    Put("proc/sys/kernel/timer_migration", "0\n");
    Put("proc/swaps", "Filename Type Size Used Priority\n");
    Put("proc/stat", "cpu  100 0 100 1000 0 0 0 0 0 0\n");
    Put("proc/net/route", "Iface Destination Gateway\nlo\t000000E0\t00000000\n");
    Put("proc/irq/default_smp_affinity", "1\n");
    const std::string cpu = "sys/devices/system/cpu/";
    Put(cpu + "online", "0-3\n");
    Put(cpu + "isolated", "1-3\n");
    Put(cpu + "nohz_full", "1-3\n");
    Put(cpu + "cpu1/cpufreq/scaling_governor", "performance\n");
    Put(cpu + "cpu1/topology/thread_siblings_list", "1\n");
    Put(cpu + "cpu1/cpuidle/state0/latency", "2\n");
  }
  void Put(const std::string& path, const std::string& text) {
    std::filesystem::create_directories((dir_ / path).parent_path());
    std::ofstream(dir_ / path) << text;
  }
  std::vector<Finding> All() const {
    const SystemRoot root(dir_.path());
    std::vector<Finding> all = CheckProcess(root);
    for (const auto& part : {CheckCpu(root, demand_), CheckSystem(root)})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }
  Finding Named(const std::string& name) const {
    for (const Finding& finding : All())
      if (finding.name == name) return finding;
    ADD_FAILURE() << "no finding " << name;
    return {};
  }
  /// The finding is of that level, and says what to do when it is not ok.
  void Expect(const std::string& name, Level level) const {
    const Finding finding = Named(name);
    EXPECT_EQ(finding.level, level) << name << ": " << finding.what;
    EXPECT_EQ(finding.remedy.empty(), level == Level::kOk) << name;
    EXPECT_EQ(finding.cost.empty(), level == Level::kOk) << name;
  }

  test::ScratchDir dir_;
  Demand demand_;
};

TEST_F(RtCheck, AWellSetUpComputerHasNothingToMend) {
  for (const Finding& finding : All()) EXPECT_EQ(finding.level, Level::kOk) << finding.name << ": " << finding.what;
  EXPECT_TRUE(IsFit(All()));
}

TEST_F(RtCheck, WithoutPrivilegesItIsNotFit) {
  Put("proc/self/status", "CapEff:\t0000000000000000\n");
  Expect("rtprio", Level::kUnfit);
  Expect("memlock", Level::kUnfit);
  EXPECT_FALSE(IsFit(All()));
  Put("proc/self/limits", "Max locked memory  unlimited  unlimited  bytes\nMax realtime priority  99  99\n");
  Expect("rtprio", Level::kOk);
  Expect("memlock", Level::kOk);
}

TEST_F(RtCheck, FindsEachThingThatCosts) {
  Put("proc/version", "Linux version 6.1.0 #1 SMP PREEMPT_DYNAMIC\n");
  Expect("kernel", Level::kAdvice);
  Put("proc/sys/net/core/rmem_max", "212992\n");
  Expect("socket_buffer", Level::kAdvice);
  Put("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
  Expect("rt_throttling", Level::kAdvice);
  EXPECT_NE(Named("rt_throttling").cost.find("50 ms"), std::string::npos);
  Put("proc/sys/kernel/timer_migration", "1\n");
  Expect("timer_migration", Level::kAdvice);
  Put("proc/swaps", "Filename Type\n/dev/sda2 partition\n");
  Expect("swap", Level::kAdvice);
  Put("proc/stat", "cpu  100 0 100 1000 0 0 0 12 0 0\n");
  Expect("hypervisor", Level::kAdvice);
  Put("proc/net/route", "Iface Destination\neth0\t0000FEA9\n");
  Expect("multicast", Level::kUnfit);
  EXPECT_TRUE(IsFit({Named("swap")})) << "advice is no verdict";
}

TEST_F(RtCheck, FindsWhatAProcessorShares) {
  const std::string cpu = "sys/devices/system/cpu/";
  Put(cpu + "isolated", "2-3\n");
  Expect("isolation", Level::kAdvice);
  EXPECT_NE(Named("isolation").remedy.find("nohz_full=1"), std::string::npos);
  Put("proc/irq/default_smp_affinity", "f\n");
  Expect("irq_affinity", Level::kAdvice);
  Put(cpu + "cpu1/cpufreq/scaling_governor", "powersave\n");
  Expect("governor", Level::kAdvice);
  Put(cpu + "cpu1/cpuidle/state3/latency", "1500\n");
  Expect("idle_states", Level::kAdvice);
  Put(cpu + "cpu1/cpuidle/state3/disable", "1\n");
  Expect("idle_states", Level::kOk);
  demand_.period_ms = 1.0;
  Expect("cpu_idle", Level::kAdvice);
  Put("dev/cpu_dma_latency", "");
  Expect("cpu_idle", Level::kOk);
  Put(cpu + "cpu1/topology/thread_siblings_list", "1,3\n");
  Expect("smt", Level::kAdvice);
  Put(cpu + "online", "0\n");
  Expect("cpus", Level::kUnfit);
}

TEST_F(RtCheck, AnEmptyTreeIsToldWithoutAnError) {
  const test::ScratchDir empty;
  const SystemRoot root(empty.path());
  EXPECT_FALSE(CheckCpu(root, Demand{}).empty());
  EXPECT_FALSE(CheckSystem(root).empty());
  EXPECT_FALSE(IsFit(CheckProcess(root)));
}

TEST(ParseCpuList, ReadsWhatTheKernelWrites) {
  EXPECT_EQ(ParseCpuList("0,2-4"), (std::set<int>{0, 2, 3, 4}));
  EXPECT_TRUE(ParseCpuList("").empty());
  EXPECT_TRUE(ParseCpuList("(null)").empty());
}

TEST(CheckWakeUps, IsJudgedAgainstTheDeadline) {
  WakeUps wake_ups;
  for (int i = 0; i < 10'000; ++i) wake_ups.late_ns.Add(50'000);
  EXPECT_EQ(CheckWakeUps(wake_ups, {100.0, 100.0, 1}).level, Level::kOk);
  wake_ups.late_ns.Add(20'000'000);
  EXPECT_EQ(CheckWakeUps(wake_ups, {100.0, 100.0, 1}).level, Level::kOk);
  EXPECT_EQ(CheckWakeUps(wake_ups, {10.0, 10.0, 1}).level, Level::kUnfit) << "a whole deadline at once";
  EXPECT_EQ(CheckWakeUps(wake_ups, {1.0, 0.1, 1}).level, Level::kUnfit);
  EXPECT_EQ(CheckWakeUps(WakeUps{}, Demand{}).level, Level::kUnfit) << "nothing was measured";
}

TEST_F(RtCheck, TheProgramTellsItsVerdictByItsExitCode) {
  using test::RunProgram;
  const auto fit = RunProgram(test::Program("armcmc-rtcheck"), {"--root", dir_.path(), "--seconds", "0", "--json"});
  EXPECT_EQ(fit.code, 0) << fit.err;
  EXPECT_TRUE(test::Json::Parse(fit.out)["fit"].get<bool>());
  Put("proc/net/route", "Iface Destination\n");
  const auto unfit = RunProgram(test::Program("armcmc-rtcheck"), {"--root", dir_.path(), "--seconds", "0"});
  EXPECT_EQ(unfit.code, 3);
  EXPECT_NE(unfit.out.find("ip route add 224.0.0.0/4"), std::string::npos);
  EXPECT_EQ(RunProgram(test::Program("armcmc-rtcheck"), {"--period-ms", "0"}).code, 2);
}

TEST_F(RtCheck, MeasuresWakeUps) {
  const auto run = test::RunProgram(test::Program("armcmc-rtcheck"),
                                    {"--root", dir_.path(), "--cpu", "0", "--seconds", "0.2", "--json"});
  const auto json = test::Json::Parse(run.out);
  EXPECT_GT(json["wake_up_ms"]["count"], 0);
  EXPECT_GT(json["wake_up_ms"]["histogram"].size(), 0U);
}

}  // namespace
}  // namespace armcmc::rtcheck::rtcheck_test
