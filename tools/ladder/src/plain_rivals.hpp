#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "armcmc/ladder/climb.hpp"
#include "rival.hpp"

namespace armcmc::ladder {

/// Rivals of an effect that are as plain as errors of a model and of its data can be, each with one parameter or two:
///
/// - the zero of the output is elsewhere, y + b, or drifts, y + b + r (t - m) / w. Far from the place about which it is
///   curved, a cubic spring is an offset; and what a slow drift moves back and forth looks like a play;
/// - the modes of the law change elsewhere: a signal s that the condition of a mode reads is s - d in the whole plant.
///   The condition takes its limit for granted, as a contact its surface, and a law that begins elsewhere looks like a
///   spring that stiffens;
/// - a parameter p drifts, p (1 + e (t - m) / w) with |e| <= 1/3, m the middle and w half of the recording. A stiffness
///   that changes with time looks like a force that drifts, or like a slow memory. So it is a rival of effects that
///   remember, or respond to nothing;
/// - the output follows its past, y + c (x - low pass of x), x the law or a signal. Most bodies relax a little, and
///   what fades while a body is held looks like a friction that builds up after each reversal. So it is a rival of
///   effects that remember and add;
/// - the output has a term in proportion to a signal, y + c (x - mean of x). A curve that is straight as far as the
///   data reach is none: a dry friction so smooth that it never slips is a viscous one. Nor is a memory that is
///   forgotten at once. So it is a rival of effects that are a function of the same signal, and of those that relax.
///
/// Where an effect of the catalogue does the same, that competes by its name, and the rival is left out.
class PlainRivals {
 public:
  /// All outlive it.
  /// @param contenders  Of the same rung.
  PlainRivals(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, const Trial& base,
              const DataScales& scales, const std::vector<Contender>& contenders);

  /// A rival that explains as much as an effect. Fitted when it is first asked for.
  /// @pre c.trial.judged.
  [[nodiscard]] std::optional<Rival> RivalOf(const Contender& c);

 private:
  /// Whether the rival is one in this plant that no contender is.
  [[nodiscard]] bool IsNotInCatalogue(const Candidate& rival) const;

  const std::shared_ptr<const Plant>& plant_;
  const Dataset& data_;
  const View& view_;
  const Trial& base_;
  const DataScales& scales_;
  const std::vector<Contender>& contenders_;
  std::vector<EffectEntry> plain_entries_, slow_entries_, past_entries_, straight_entries_;
  std::optional<std::vector<Contender>> plain_, slow_, past_;
};

}  // namespace armcmc::ladder
