#pragma once

#include <ostream>

#include "armcmc/estimate.hpp"
#include "armcmc/replay/pack_source.hpp"

namespace armcmc::replay {

/// Writes the measured output of every sample beside what was predicted for it: columns t, pack, y, y_shown (with the
/// estimates on display at that time), y_shown_free_run (from the inputs alone since the start; actuator).
class PredictionCsv {
 public:
  explicit PredictionCsv(std::ostream* out);
  void Write(const RecordedPack& recorded, const Estimate& estimate);

 private:
  std::ostream* out_;
};

}  // namespace armcmc::replay
