#pragma once

#include <cstdint>
#include <string_view>

namespace armcmc {

/// What the gap watch has found so far.
struct GapState {
  bool watched = false;         ///< The watch is on.
  bool suspected = false;       ///< The alarm: the model misses something. Stays until Estimator::Reset().
  int check = -1;               ///< The check with the most evidence, an index into GapFamily::checks; -1: none yet.
  std::string_view where;       ///< Its name; static storage.
  double log_evidence = 0.0;    ///< ln e-value against "no gap", nats; at most 0 on average when there is none.
  double log_threshold = 0.0;   ///< The alarm rises when log_evidence passes this, nats.
  double share = 0.0;           ///< Of the squared error beyond the noise that this check explains, [0, 1].
  std::int64_t since_seq = 0;   ///< First pack of the blocks that speak for the gap; 0: none.
  std::int64_t alarm_seq = 0;   ///< Pack at which the alarm rose; 0: none.
  std::int64_t num_blocks = 0;  ///< Blocks judged.
};

}  // namespace armcmc
