#pragma once

#include <optional>
#include <string>
#include <vector>

#include "armcmc/ladder/climb.hpp"
#include "rival.hpp"

namespace armcmc::ladder {

/// What no catalogue has a formula for: something of the law that is not constant but follows one quantity by a curve.
///
/// The curve is sum_k c_k max(1 - ((x - m_k) / w)^2, 0)^4, bumps over the range of x, which is a signal, a state or
/// time. It is added to a parameter, the output, an input (of itself) or the rate of a state.
///
/// These are the curves that explain most of what a model leaves. Fitted when they are first asked for.
class Curves {
 public:
  /// All outlive it.
  Curves(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, const Trial& base,
         const DataScales& scales);

  /// The curve that rules a contender out; nothing where none does.
  /// @param smaller_part  It would be named only with another one: then a curve that holds it rules it out, too.
  /// @pre c.trial.judged.
  [[nodiscard]] std::optional<Rival> RivalOf(const Contender& c, bool smaller_part);

  /// The curve of something that an effect named before reads, if it explains as much as a contender: that effect's
  /// formula may be as little off.
  /// @pre c.trial.judged.
  [[nodiscard]] std::optional<Rival> BendOf(const Contender& c, const std::vector<const Candidate*>& before);

  /// The best of them, in words; empty where it leaves half of the squared error or more.
  [[nodiscard]] std::string Best();

 private:
  void FitThem();
  void Judge(Contender* curve);
  /// Of those that act differently the ones that explain most, by one step from the model without them.
  [[nodiscard]] std::vector<Candidate> MostPromising() const;
  /// Whether a curve can do what an effect does: in place of it, or as a curve of something that the effect reads, too.
  [[nodiscard]] bool Holds(const Contender& curve, const Contender& c) const;

  const std::shared_ptr<const Plant>& plant_;
  const Dataset& data_;
  const View& view_;
  const Trial& base_;
  const DataScales& scales_;
  std::vector<EffectEntry> entries_;              ///< Of all curves.
  std::optional<std::vector<Contender>> fitted_;  ///< Best first.
};

}  // namespace armcmc::ladder
