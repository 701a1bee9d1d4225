#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "armcmc/plant_sim/options.hpp"

namespace armcmc::plant_sim {

/// What a law of nature differs by from the formula that people write down for it: a smooth factor, another one for
/// every seed,
///
///   1 + share sqrt(2 / n) sum_i cos(k_i a + l_i b + phase_i)
///
/// of two variables in units of their ranges. No wave is shorter than those, so that nothing bends, jumps or turns back
/// as an effect does. Over the seeds the rms of what it adds to 1 is `share`; a part of that the parameters absorb.
class LawError {
 public:
  /// @param share  0: the law is the formula.
  LawError(double share, std::uint64_t seed);

  /// @rt No heap, no lock, no throw.
  [[nodiscard]] double Factor(double a, double b) const noexcept;

 private:
  struct Wave {
    double k, l, phase;  ///< rad per range of a and of b, rad.
  };
  static constexpr std::size_t kNumWaves = 6;
  double amplitude_;
  std::array<Wave, kNumWaves> waves_{};
};

/// `error` of the table [law]: the share.
[[nodiscard]] OptionSpec LawErrorOption();

}  // namespace armcmc::plant_sim
