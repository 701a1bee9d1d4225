#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// Name of a check, stored by value, because the names of a described plant live only as long as its estimator. Names
/// longer than 48 bytes are cut.
/// @rt No heap, no lock, no throw.
class GapCheckText {
 public:
  /// Copies the text, and cuts it after 48 bytes. O(1).
  GapCheckText& operator=(std::string_view text) noexcept ARMCMC_NONBLOCKING {
    text_.fill('\0');
    size_ = std::min(text.size(), text_.size());
    std::copy_n(text.data(), size_, text_.data());
    return *this;
  }
  /// The text; valid until the next assignment.
  [[nodiscard]] std::string_view view() const noexcept ARMCMC_NONBLOCKING { return {text_.data(), size_}; }

 private:
  std::array<char, 48> text_{};
  std::size_t size_ = 0;
};

/// State of the gap watch after a pack: whether the data contradict the model beyond the noise, and where. Published in
/// estimator_status_t.
struct GapState {
  bool watched = false;         ///< The watch is on.
  bool suspected = false;       ///< The alarm: the model is missing something. Stays until Estimator::Reset().
  int check = -1;               ///< The check with the most evidence, an index into GapFamily::checks; -1: none yet.
  GapCheckText where;           ///< Its name.
  double log_evidence = 0.0;    ///< ln e-value against "no gap", nats; at most 0 on average when there is none.
  double log_threshold = 0.0;   ///< The alarm rises when log_evidence passes this, nats.
  double share = 0.0;           ///< Share of the squared error beyond the noise that this check explains, [0, 1].
  std::int64_t since_seq = 0;   ///< First pack of the blocks with evidence for the gap; 0: none.
  std::int64_t alarm_seq = 0;   ///< Pack at which the alarm rose; 0: none.
  std::int64_t num_blocks = 0;  ///< Blocks judged.
};

}  // namespace armcmc
