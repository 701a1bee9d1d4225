#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/stress/bus_watch.hpp"
#include "armcmc/stress/child.hpp"
#include "armcmc/stress/options.hpp"

namespace armcmc::stress {

/// One plant after another beside a running estimator, with the faults of the layout in each long run.
class PlantRuns {
 public:
  struct Context {
    const StressOptions* options;
    std::string lcm_url;
    std::filesystem::path scenario;
    BusWatch* bus;
    FaultJudge* judge;
    Child* estimator;
    std::function<void()> tick;  ///< Called many times a second.
  };

  PlantRuns(Context context, FaultLayout layout);

  /// A run with every fault of the layout, ended as a full disk of its log wants it.
  void RunWithFaults();
  /// A run without faults, of so many ms.
  void RunQuietly(double ms);
  /// A short run; it shows that the estimator continues after the end of the previous plant, and ends abruptly itself.
  void RunShortly();
  [[nodiscard]] bool estimator_died() const { return estimator_died_; }

 private:
  void Start(const std::string& plan, std::vector<Slot> slots, bool log_fails);
  /// Until the judge has seen all slots, or the time is over.
  void Supervise(double most_ms);
  void DriveSignals();
  void BeginSignal(const FaultSpec& fault);
  void EndSignal(const FaultSpec& fault);
  void Pause(double ms);
  [[nodiscard]] const FaultSpec* Selected(const char* name) const;

  Context context_;
  FaultLayout layout_;
  std::unique_ptr<Child> plant_, flood_;
  const FaultSpec* ended_by_ = nullptr;  // fault with which the plant before ended
  bool log_failure_reported_ = false;
  const FaultSpec* active_ = nullptr;  // a signal that is on
  const Slot* handled_ = nullptr;      // the slot whose signal was sent
  std::int64_t active_since_ns_ = 0, active_until_ns_ = 0;
  bool estimator_died_ = false;
};

}  // namespace armcmc::stress
