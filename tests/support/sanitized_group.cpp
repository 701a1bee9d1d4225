#include <gtest/gtest.h>
#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

// What the tests of a group need where the group runs under a sanitizer, as one test of ctest.
namespace armcmc::test {
namespace {

/// Ends the process when one TEST takes longer than any test does. The limit of ctest is that of the whole group:
/// without this, a TEST that hangs costs an hour and has no name. The signal keeps its default action, which needs
/// nothing from a process that hangs; the last line that GoogleTest printed names the TEST.
class TimeLimit : public testing::EmptyTestEventListener {
 public:
  static constexpr unsigned kSeconds = 300;

 private:
  void OnTestStart(const testing::TestInfo&) override { alarm(kSeconds); }
  void OnTestEnd(const testing::TestInfo&) override { alarm(0); }
};

/// Takes the right to real-time priorities from this process and from the programs that it starts.
///
/// Locks of the run-time library of ThreadSanitizer spin with sched_yield(), also at the end of a thread. When a
/// SCHED_FIFO thread waits for such a lock, and the thread that holds it has a lower priority and the same CPU, neither
/// ever runs again. Data races are found at any priority.
[[maybe_unused]] void GiveUpRealTimePriorities() {
  const rlimit none{0, 0};
  setrlimit(RLIMIT_RTPRIO, &none);
  prctl(PR_CAPBSET_DROP, CAP_SYS_NICE);  // of programs that root starts
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct rights[_LINUX_CAPABILITY_U32S_3]{};
  if (syscall(SYS_capget, &header, rights) != 0) return;
  auto& word = rights[CAP_TO_INDEX(CAP_SYS_NICE)];
  word.effective &= ~CAP_TO_MASK(CAP_SYS_NICE);
  word.permitted &= ~CAP_TO_MASK(CAP_SYS_NICE);
  word.inheritable &= ~CAP_TO_MASK(CAP_SYS_NICE);
  syscall(SYS_capset, &header, rights);
}

/// Before the first TEST, and before any thread.
const bool kPrepared = [] {
  testing::UnitTest::GetInstance()->listeners().Append(new TimeLimit);  // GoogleTest owns it
#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
  GiveUpRealTimePriorities();
#endif
#endif
  return true;
}();

}  // namespace
}  // namespace armcmc::test
