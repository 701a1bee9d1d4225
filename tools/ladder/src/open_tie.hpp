#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

/// A tie that later rungs may decide: the model with each of the tied effects, and with what was named since.
///
/// What is missing besides hides which of two effects is present: friction and hysteresis look alike until the spring
/// that acts with them is in the model. An effect that is named later must therefore not depend on the choice.
class OpenTie {
 public:
  /// @param place  Index of the rung. @pre It names several effects.
  OpenTie(std::size_t place, const Rung& rung);

  /// Adds the leader of the next rung to every branch, and leaves out the effects of the tie that the data then
  /// exclude.
  /// @param next  Its base is the model of the first branch.
  /// @param families  Of the effects named before.
  /// @return whether the leader passes rule 1 of Climb() on every branch and is none of the tied effects; if not,
  /// nothing
  ///   is changed.
  [[nodiscard]] bool Extend(const Dataset& data, const View& view, const DataScales& scales, double floor,
                            const std::set<std::string>& families, const std::vector<EffectEntry>& entries,
                            const Rung& next);

  /// Writes the first branch into the ladder: which effects of the rung are still tied, and the leaders of the rungs
  /// above it as fitted there.
  void ResolveTie(Ladder* ladder) const;

  [[nodiscard]] bool decided() const { return branches_.size() == 1; }

 private:
  struct Branch {
    std::size_t tied;              ///< Index of the effect among the contenders of the rung.
    Candidate effect;              ///< The same.
    std::vector<Contender> above;  ///< The leader of every later rung.
    Trial trial;                   ///< With all of them.
  };

  std::size_t place_;
  std::vector<Branch> branches_;  ///< The best first.
};

}  // namespace armcmc::ladder
