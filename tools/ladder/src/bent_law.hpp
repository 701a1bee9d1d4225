#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/ladder/climb.hpp"
#include "rival.hpp"

namespace armcmc::ladder {

/// A rival of effects that respond to nothing, such as an offset or a drift: a law that is straight where the plant is
/// bent. Over the range that a recording visits, the best straight line misses the zero of the true curve, and that
/// looks like an offset: a loss by radiation like a thermometer that reads too high.
///
/// One parameter of the law varies by at most a third on either side of the middle of a range,
///
///   p (1 + e (x - m) / w),  |e| <= 1/3,
///
/// where x is a signal or a state, m the middle and w half of its range.
class BentLaw {
 public:
  /// All outlive it.
  BentLaw(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, const Trial& base,
          const DataScales& scales);

  /// A parameter that explains as much as an effect that depends on nothing but time, if it varies with a quantity.
  /// Fitted when it is first asked for.
  /// @pre c.trial.judged.
  [[nodiscard]] std::optional<Rival> RivalOf(const Contender& c);

 private:
  void FitRivals();

  const std::shared_ptr<const Plant>& plant_;
  const Dataset& data_;
  const View& view_;
  const Trial& base_;
  const DataScales& scales_;
  std::vector<EffectEntry> entries_;
  std::optional<std::vector<Contender>> fitted_;
};

}  // namespace armcmc::ladder
