#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "armcmc/stress/fault_catalog.hpp"

namespace armcmc::stress {

/// What a stress run is asked to do.
struct StressOptions {
  double minutes = 10.0;
  std::vector<std::string> loads = {"none", "cpu", "memory", "io", "net", "watchers"};
  std::vector<const FaultSpec*> faults;
  double period_ms = 100.0;
  double deadline_ms = 0.0;  ///< 0: the period.
  std::string draws = "chernoff";
  int samples = 100;    ///< Of a pack.
  std::string lcm_url;  ///< Empty: a port of its own.
  std::string prefix = "STRESS_";
  std::filesystem::path work;      ///< Folder for configurations, reports and the files of the load.
  std::filesystem::path programs;  ///< Folder of armcmc-plant and armcmc-estimator.

  [[nodiscard]] double DeadlineMs() const { return deadline_ms > 0.0 ? deadline_ms : period_ms; }
};

}  // namespace armcmc::stress
