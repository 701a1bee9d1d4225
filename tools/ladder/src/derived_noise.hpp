#pragma once

#include <optional>

#include "armcmc/ladder/climb.hpp"
#include "rival.hpp"

namespace armcmc::ladder {

/// Noise of derived signals (rates of other signals) as a rival: an effect that smooths them seems to explain what is
/// only their noise.
///
/// The rival is the unextended model on signals smoothed symmetrically in time, with several kernel widths. It is
/// fitted at the first call that needs it.
class DerivedNoise {
 public:
  /// The arguments must outlive this.
  DerivedNoise(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, const Trial& base)
      : plant_(plant), data_(data), view_(view), base_(base) {}

  /// Empty if smoother signals explain nothing, or less than a contender that explains as much with the smoother
  /// signals.
  /// @pre c.trial.judged.
  [[nodiscard]] std::optional<Rival> RivalOf(const Contender& c);

 private:
  struct Smoothed {
    double sd;  ///< Standard deviation of the smoothing kernel, s.
    Dataset data;
    Contender contender;
  };
  void FitSmoothed();
  /// Whether an effect keeps at least half of its gain on the smoothed signals.
  [[nodiscard]] bool GainsThere(const Contender& c) const;

  const std::shared_ptr<const Plant>& plant_;
  const Dataset& data_;
  const View& view_;
  const Trial& base_;
  bool fitted_ = false;
  std::optional<Smoothed> best_;
};

}  // namespace armcmc::ladder
