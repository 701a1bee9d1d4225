#pragma once

#include <lcm/lcm-cpp.hpp>
#include <string>

#include "armcmc/rt/log_histogram.hpp"
#include "armcmc/stress/fault_judge.hpp"
#include "armcmc/stress/flight_recorder.hpp"

namespace armcmc::stress {

/// Hears what plant and estimator say and hands it to the judge.
class BusWatch {
 public:
  /// @throws std::runtime_error when the bus cannot be joined.
  BusWatch(const std::string& url, const std::string& prefix);

  /// Handles what comes within so many ms; `judge` may be nullptr.
  void Poll(int ms, FaultJudge* judge);
  /// Hears every status before the judge does; nullptr for none.
  void SetRecorder(FlightRecorder* recorder) { recorder_ = recorder; }

  /// Newest pack number on the bus in this run of the plant; forgotten by BeginRun().
  [[nodiscard]] std::int64_t newest_pack() const { return newest_pack_; }
  void BeginRun() { newest_pack_ = 0; }
  [[nodiscard]] std::int64_t statuses() const { return statuses_; }
  /// Release to estimate of every step, ns; of this phase, after BeginPhase().
  [[nodiscard]] const rt::LogHistogram& end_to_end() const { return end_to_end_; }
  void BeginPhase();

 private:
  static void OnPack(const lcm::ReceiveBuffer* buffer, const std::string& channel, BusWatch* self);
  static void OnEstimate(const lcm::ReceiveBuffer* buffer, const std::string& channel, const estimate_t* message,
                         BusWatch* self);
  static void OnStatus(const lcm::ReceiveBuffer* buffer, const std::string& channel, const estimator_status_t* message,
                       BusWatch* self);

  lcm::LCM bus_;
  FaultJudge* judge_ = nullptr;
  FlightRecorder* recorder_ = nullptr;
  std::int64_t newest_pack_ = 0, statuses_ = 0, last_step_ = 0;
  rt::LogHistogram end_to_end_;
};

}  // namespace armcmc::stress
