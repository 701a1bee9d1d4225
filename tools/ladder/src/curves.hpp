#pragma once

#include <optional>
#include <string>
#include <vector>

#include "armcmc/ladder/climb.hpp"
#include "rival.hpp"

namespace armcmc::ladder {

/// Unnamed rivals of the catalogue: a part of the law that is not constant but a smooth curve of one quantity.
///
/// The curve is sum_k c_k max(1 - ((x - m_k) / w)^2, 0)^4, bumps over the range of x, which is a signal, a state or
/// time. It is added to a parameter, to the output, to an input (as a function of that input), or to the rate of a
/// state.
///
/// Only the curves that explain most of the residual are fitted, at the first call that needs them.
class Curves {
 public:
  /// The arguments must outlive this.
  Curves(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, const Trial& base,
         const DataScales& scales);

  /// The curve that rules out a contender, if there is one: rule 4 of Climb().
  /// @param smaller_part  The contender removes less than half of the error, so it would be named only with another
  ///   one; a curve that can represent it then also rules it out.
  /// @pre c.trial.judged.
  [[nodiscard]] std::optional<Rival> RivalOf(const Contender& c, bool smaller_part);

  /// A curve of a quantity that an already named effect reads, if it explains as much as the contender: an inaccuracy
  /// of that effect's formula is then as plausible.
  /// @pre c.trial.judged.
  [[nodiscard]] std::optional<Rival> BendOf(const Contender& c, const std::vector<const Candidate*>& before);

  /// The best curve in words; empty if it leaves half of the squared error or more.
  [[nodiscard]] std::string Best();

 private:
  void FitRivals();
  void Judge(Contender* curve);
  /// The curves that explain most, one for each different action, ranked by one Gauss-Newton step.
  [[nodiscard]] std::vector<Candidate> MostPromising() const;
  /// Whether a curve can represent an effect: see rule 4 of Climb().
  [[nodiscard]] bool Holds(const Contender& curve, const Contender& c) const;

  const std::shared_ptr<const Plant>& plant_;
  const Dataset& data_;
  const View& view_;
  const Trial& base_;
  const DataScales& scales_;
  std::vector<EffectEntry> entries_;              ///< Entries of all curves.
  std::optional<std::vector<Contender>> fitted_;  ///< Best first.
};

}  // namespace armcmc::ladder
