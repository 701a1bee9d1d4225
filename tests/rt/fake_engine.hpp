#pragma once

#include <pthread.h>
#include <time.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <new>
#include <string_view>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/step_engine.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "test_threads.hpp"

namespace armcmc::rt::test {

/// What a real-time stage must never do.
enum class Planted { kNothing, kAllocation, kLock, kSystemCall };

ARMCMC_TRUST_NONBLOCKING_BEGIN  // hidden from the compiler on purpose: whoever runs it has to notice
    inline void
    PlantedFault(Planted fault) noexcept ARMCMC_NONBLOCKING {
  if (fault == Planted::kAllocation) {
    auto* leak = new (std::nothrow) int(1);
    asm volatile("" : : "g"(leak) : "memory");
    delete leak;
  } else if (fault == Planted::kLock) {
    pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
    pthread_mutex_lock(&mutex);
    pthread_mutex_unlock(&mutex);
  } else if (fault == Planted::kSystemCall) {
    const timespec moment{0, 1};
    nanosleep(&moment, nullptr);
  }
}
ARMCMC_TRUST_NONBLOCKING_END

/// An engine whose result is the pack number, and whose time is set by the test.
class FakeEngine : public StepEngine {
 public:
  [[nodiscard]] PackFormat pack_format() const noexcept ARMCMC_NONBLOCKING override {
    return {HuntCrossley::kInfo.plant, 2};
  }
  [[nodiscard]] int num_modes() const noexcept ARMCMC_NONBLOCKING override { return 1; }
  [[nodiscard]] int num_reported() const noexcept ARMCMC_NONBLOCKING override { return 2; }
  [[nodiscard]] ReportedQuantity reported(int index) const noexcept ARMCMC_NONBLOCKING override {
    return index == 0 ? ReportedQuantity{"K", "N/m^p"} : ReportedQuantity{"a_name_of_more_than_15_characters", "-"};
  }
  [[nodiscard]] std::string_view mode_name(int) const noexcept ARMCMC_NONBLOCKING override { return "contact"; }

  Status Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock,
                int slot) noexcept ARMCMC_NONBLOCKING override {
    auto& result = results_[static_cast<std::size_t>(slot)];
    result.seq = pack.seq;
    result.run_id = pack.run_id;
    result.last_y = pack.y[static_cast<std::size_t>(pack.num_samples - 1)];
    adjusted.fetch_add(1);
    last_budget_ns.store(deadline_ns - clock.Now());
    if (const Nanos sleep_ns = adjust_sleep_ns.load(); sleep_ns > 0) SleepUntil(clock.Now() + sleep_ns);
    WorkFor(adjust_work_ns.load());
    PlantedFault(planted.load());
    return status.load();
  }

  void Remember(ClockRef) noexcept ARMCMC_NONBLOCKING override { remembered.fetch_add(1); }

  void Execute(int slot, Estimate* estimate) noexcept ARMCMC_NONBLOCKING override {
    const auto& result = results_[static_cast<std::size_t>(slot)];
    *estimate = Estimate{};
    estimate->seq = result.seq;
    estimate->run_id = result.run_id;
    estimate->num_modes = 1;
    estimate->num_reported = 2;
    estimate->active = true;
    estimate->y_pred = result.last_y;
    ModeEstimate& mode = estimate->modes[0];
    mode.known = mode.updated = true;
    mode.decision = Decision::kReinforcement;
    mode.draws = 1000;
    mode.ess = 500.0;
    mode.marginal[0].ar_map = static_cast<double>(result.seq);
    mode.marginal[0].sd = 0.5;
    mode.marginal[0].histogram_hi = 1.0;
    mode.marginal[0].density.fill(1.0);
  }

  void Reset() noexcept ARMCMC_NONBLOCKING override { adjusted.store(0); }

  std::atomic<Nanos> adjust_sleep_ns{0};
  std::atomic<Nanos> adjust_work_ns{0};  // CPU time
  std::atomic<Nanos> last_budget_ns{0};
  std::atomic<int> adjusted{0};
  std::atomic<int> remembered{0};
  std::atomic<Planted> planted{Planted::kNothing};
  std::atomic<Status> status{Status::kOk};

 private:
  struct Result {
    std::int64_t seq = 0, run_id = 0;
    double last_y = 0.0;
  };
  std::array<Result, LatestValue::kSlots> results_{};
};

}  // namespace armcmc::rt::test
