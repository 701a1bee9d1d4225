#include "armcmc/rt/cpu_time_meter.hpp"

#include <sys/resource.h>
#include <time.h>

#include <algorithm>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/system_call.hpp"
#include "armcmc/rt/witness.hpp"

namespace armcmc::rt {

ARMCMC_TRUST_NONBLOCKING_BEGIN  // two questions to the kernel that it answers at once

    Nanos
    ThreadCpuTime() noexcept ARMCMC_NONBLOCKING {
  const SystemCall ask;
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<Nanos>(t.tv_sec) * kNanosPerSecond + static_cast<Nanos>(t.tv_nsec);
}

namespace {

/// How often the calling thread has waited for something.
std::int64_t Sleeps() noexcept ARMCMC_NONBLOCKING {
  const SystemCall ask;
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nvcsw;
}

}  // namespace

ARMCMC_TRUST_NONBLOCKING_END

void CpuTimeMeter::AddOther(const std::atomic<Nanos>* cpu_time_ns, bool goes_first) noexcept {
  if (num_others_ < kMaxOthers) others_[num_others_++] = {cpu_time_ns, goes_first};
}

CpuTimeMeter::Use CpuTimeMeter::Used() const noexcept ARMCMC_NONBLOCKING {
  const Nanos own_ns = ThreadCpuTime();
  Use use{own_ns, own_ns};
  for (std::size_t i = 0; i < num_others_; ++i) {
    const Nanos other_ns = others_[i].cpu_time_ns->load(std::memory_order_relaxed);
    use.all_ns += other_ns;
    if (others_[i].goes_first) use.first_ns += other_ns;
  }
  return use;
}

Nanos CpuTimeMeter::WithheldWaiting(Nanos now_ns, const Use& used) const noexcept {
  if (!trusted_.load(std::memory_order_relaxed) || woken_ns_ == 0 || end_ns_ == 0) return 0;
  const Nanos waited_ns = now_ns - std::max(woken_ns_, end_ns_);
  return std::max<Nanos>(0, waited_ns - (used.first_ns - used_at_end_.first_ns) - WakeUpRing::kOrdinaryDelayNs);
}

Nanos CpuTimeMeter::WithheldWaiting(Nanos now_ns) const noexcept ARMCMC_NONBLOCKING {
  return WithheldWaiting(now_ns, Used());
}

Nanos CpuTimeMeter::Start() noexcept ARMCMC_NONBLOCKING {
  sleeps_at_start_ = Sleeps();
  used_at_start_ = Used();
  start_ns_ = MonotonicNow();
  withheld_before_ns_ = WithheldWaiting(start_ns_, used_at_start_);
  return start_ns_;
}

Nanos CpuTimeMeter::Withheld(Nanos begin_ns, const Use& at_begin, Nanos end_ns) noexcept {
  end_ns_ = end_ns;
  used_at_end_ = Used();
  if (!trusted_.load(std::memory_order_relaxed) || Sleeps() != sleeps_at_start_) return 0;
  return std::max<Nanos>(0, end_ns - begin_ns - (used_at_end_.all_ns - at_begin.all_ns));
}

Nanos CpuTimeMeter::End(Nanos end_ns) noexcept ARMCMC_NONBLOCKING {
  return Withheld(start_ns_, used_at_start_, end_ns);
}

Nanos CpuTimeMeter::Continue(Nanos end_ns) noexcept ARMCMC_NONBLOCKING {
  const Use at_begin = used_at_end_;
  return Withheld(end_ns_, at_begin, end_ns);
}

}  // namespace armcmc::rt
