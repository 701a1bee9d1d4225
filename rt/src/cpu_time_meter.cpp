#include "armcmc/rt/cpu_time_meter.hpp"

#include <sys/resource.h>
#include <time.h>

#include <algorithm>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/system_call.hpp"

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

void CpuTimeMeter::AddOther(const std::atomic<Nanos>* cpu_time_ns) noexcept {
  if (num_others_ < kMaxOthers) others_[num_others_++] = cpu_time_ns;
}

Nanos CpuTimeMeter::Used() const noexcept ARMCMC_NONBLOCKING {
  Nanos used_ns = ThreadCpuTime();
  for (std::size_t i = 0; i < num_others_; ++i) used_ns += others_[i]->load(std::memory_order_relaxed);
  return used_ns;
}

Nanos CpuTimeMeter::Start() noexcept ARMCMC_NONBLOCKING {
  sleeps_at_start_ = Sleeps();
  used_at_start_ns_ = Used();
  start_ns_ = MonotonicNow();
  return start_ns_;
}

Nanos CpuTimeMeter::Withheld(Nanos end_ns) const noexcept ARMCMC_NONBLOCKING {
  if (!trusted_.load(std::memory_order_relaxed)) return 0;
  const Nanos used_ns = Used() - used_at_start_ns_;
  return Sleeps() == sleeps_at_start_ ? std::max<Nanos>(0, end_ns - start_ns_ - used_ns) : 0;
}

}  // namespace armcmc::rt
