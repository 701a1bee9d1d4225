// Compiled by tests only, once for each fault: the compiler has to refuse it, and accept it without any.
#include <mutex>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/step_engine.hpp"
#include "armcmc/rt/waiter.hpp"

namespace armcmc::rt {

/// What the compiler knows of a stage: it is called through an interface that is marked.
class PlantedEngine : public StepEngine {
 public:
  Status Adjust(const DataPack& pack, Nanos, ClockRef clock, int) noexcept ARMCMC_NONBLOCKING override {
#if defined(PLANT_ALLOCATION)
    last_ = new Nanos(clock.Now());
#elif defined(PLANT_LOCK)
    const std::lock_guard<std::mutex> guard(mutex_);
#elif defined(PLANT_SYSTEM_CALL)
    const timespec moment{0, 1};
    nanosleep(&moment, nullptr);
#elif defined(PLANT_THROW)
    if (pack.seq < 0) throw pack.seq;
#elif defined(PLANT_UNMARKED_ENGINE)
    Unmarked(pack);
#endif
    return clock.Now() < pack.t_last_ns ? Status::kOk : Status::kHeld;
  }

 private:
  static void Unmarked(const DataPack& pack) noexcept;  // defined elsewhere: nobody knows what it does
  std::mutex mutex_;
  Nanos* last_ = nullptr;
};

}  // namespace armcmc::rt
