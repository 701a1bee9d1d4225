#pragma once

#include <optional>

#include "armcmc/ladder/climb.hpp"
#include "rival.hpp"

namespace armcmc::ladder {

/// Noise of signals that are rates of others: an effect that smooths them seems to explain what is only their noise.
///
/// The rival is the model as it is on signals that are smoothed, forward and back alike, over several widths. Fitted
/// when it is first asked for.
class DerivedNoise {
 public:
  /// All outlive it.
  DerivedNoise(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, const Trial& base)
      : plant_(plant), data_(data), view_(view), base_(base) {}

  /// Nothing where smoother signals explain nothing, or less than the contender, which explains as much beside them.
  /// @pre c.trial.judged.
  [[nodiscard]] std::optional<Rival> RivalOf(const Contender& c);

 private:
  struct Smoothed {
    double sd;  ///< Of the kernel, s.
    Dataset data;
    Contender contender;
  };
  void FitIt();
  /// Whether an effect gains at least half as much where those signals are smoother.
  [[nodiscard]] bool GainsThere(const Contender& c) const;

  const std::shared_ptr<const Plant>& plant_;
  const Dataset& data_;
  const View& view_;
  const Trial& base_;
  bool fitted_ = false;
  std::optional<Smoothed> best_;
};

}  // namespace armcmc::ladder
