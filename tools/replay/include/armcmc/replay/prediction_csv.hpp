#pragma once

#include <cstdint>
#include <ostream>

#include "armcmc/estimate.hpp"
#include "armcmc/replay/pack_source.hpp"

namespace armcmc::replay {

/// Writes the measured output of every sample beside what was predicted for it: columns t, pack, y, y_shown (with the
/// estimates on display at that time), y_shown_free_run (from the inputs alone since the start; actuator). Of packs
/// that overlap a sample is written once, with the first pack that has it.
class PredictionCsv {
 public:
  explicit PredictionCsv(std::ostream* out, int overlap = 1);
  void Write(const RecordedPack& recorded, const Estimate& estimate);

 private:
  std::ostream* out_;
  int overlap_;
  std::int64_t last_run_ = 0, last_seq_ = 0;
};

}  // namespace armcmc::replay
