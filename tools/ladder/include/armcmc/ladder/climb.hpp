#pragma once

#include <functional>
#include <string>
#include <vector>

#include "armcmc/ladder/candidates.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/trial.hpp"
#include "armcmc/plant/effect.hpp"

namespace armcmc::ladder {

/// Squared error of one model over that of another on rows left out, by kind of group: 1 without gain.
///
/// Of blocks and regions the ratio of the sums or of the typical one, whichever is less, without those that hold nearly
/// all that shows the effect: they cannot speak against it when they are left out.
struct Comparison {
  double folds = 1.0, blocks = 1.0, regions = 1.0;
};

/// One more effect that was tried on a rung, and what it is worth on data left out.
struct Contender {
  Candidate candidate;
  Trial trial;               ///< On all training rows where it was worth it, else on the quick part.
  bool refined = false;      ///< On all of them.
  double closed = 0.0;       ///< Share of the base's squared error that is gone in the fit, [0, 1].
  Comparison alone;          ///< With the base. Of those judged.
  Comparison beside;         ///< The same where both have the flexible function beside them.
  double gain_share = 0.0;   ///< Share of bootstrap samples of stretches in which it gains at least a tenth.
  double win_share = 0.0;    ///< Share in which its family has the least error of all.
  bool larger_part = false;  ///< It takes the larger part of what is unexplained.
  bool earned = false;       ///< Its gain is more than a flexible function has, wherever it is looked for.
  bool ruled_out = false;    ///< Something that is not in the catalogue explains more.
};

/// An effect that was named, or several that the data cannot tell apart.
struct Rung {
  std::vector<std::size_t> named;  ///< In `contenders`: the effect, and one of every family that explains it as well.
  std::vector<Contender> contenders;  ///< Best first.
  double probability = 0.0;           ///< That an effect of the named family is there.
  bool open = false;                  ///< Takes the smaller part: named only with the next one.
  std::string as_if;                  ///< "K followed w by a curve": what rules the best one out; else empty.
  bool provisional = false;           ///< Seen in too few separate stretches to be judged on others.
  Trial base;                         ///< What it was compared with,
  View view;                          ///< in which view.

  [[nodiscard]] const Contender& leader() const { return contenders[named.front()]; }
};

/// Names one effect after the other until none earns its name.
struct Ladder {
  std::shared_ptr<const std::vector<EffectEntry>> entries;  ///< That candidates refer to.
  double noise_floor = 0.0;
  Trial base;                          ///< The plant as it came.
  std::vector<Rung> rungs;             ///< The last one has no name.
  std::shared_ptr<const Plant> plant;  ///< With all that was named.
  Trial final_trial;                   ///< Of that plant on all training rows.
  View view;                           ///< Of the last rung.
  double flexible_gain = 0.0;          ///< Share of the squared error that is left which a flexible function takes.
  bool complete = false;               ///< It takes next to nothing, and neighbouring samples differ by as much.
  std::vector<std::string> notes;
};

struct ClimbRequest {
  std::shared_ptr<const Plant> plant;
  std::vector<EffectEntry> entries;
  Dataset data;
  /// Standard deviation of the noise, where neighbouring samples do not tell it since the output was filtered; else 0.
  double known_noise = 0.0;
  /// Standard deviation of the noise over what differences of neighbouring samples tell of it: more than 1 where they
  /// are interpolated and share noise.
  double noise_over_differences = 1.0;
  int max_rungs = 5;
  /// Rows at most that a simulated plant is compared on.
  std::size_t most_simulated = kMostSimulated;
  std::function<void(const std::string& step, double share)> progress;
};

/// The rule of a rung, after every candidate was fitted:
///
/// 1. Earned. On data left out it
///    - takes at least a tenth of the squared error in folds, in 99 % of bootstrap samples of their stretches (in 95 %,
///      provisionally, on the first rung);
///    - does not lose where long blocks or regions are left out;
///    - gains even beside a flexible function: 5 % in two of these three senses, or 20 % in one
///      without losing in the others;
///    - takes the larger part of what is unexplained, alone or with the next one, unless its family has been named
///      before or it leaves nothing but noise,
///    and the data tell one of its amplitudes: more than two standard deviations from none.
/// 2. Simplest first. Of those that close 95 % of what the best closes the ones with the fewest parameters, and of
///    these the best, and of those within 1 % of it the one that reads fewest quantities. What a simple effect leaves
///    is looked at on the next rung.
/// 3. Ties. With it go what is kin to it and leaves less than half as much again, where its own formula is not exact;
///    a family of as few parameters that wins one bootstrap sample in twenty; and a larger effect of another family
///    that leaves less than half and is better wherever it is looked for. Behind a tie nothing more is named: it would
///    stand on what is not known. So each of them shows the form of it that predicts best.
/// 4. Nothing simpler to say. What leaves more than noise is ruled out by a curve: one part of the law that follows one
///    quantity in a way that no formula of the catalogue has, leaves less than half, is better in blocks, does not lose
///    in regions, and does not hold the effect. It holds none that remembers; one that is a function of the same
///    quantity in the same equations; and one that reads that quantity, where its best copy of what the effect predicts
///    is off by less than a tenth of the squared error that the effect leaves; and none that needs the next one to take
///    the larger part, as one curve is simpler than two effects. So it is where the model as it is leaves
///    less on smoother signals, of those that are rates of others: their noise is what is unexplained. And an effect of
///    another family that is less than a third of what was named before is ruled out where it acts like that, or by a
///    curve that explains as much and follows what that reads.
///    And so it is where a constant of the plant explains as much with another value, up to 5 % away.
/// 5. Confirmed. What is named is withdrawn where the rows kept apart do not show half of its gain, or cannot be
///    predicted with it, unless they can with the next one, too; and where a
///    later rung names it again in the same place and it is an effect of which two are pieces of a curve that is none
///    of theirs, as plays are of a spring that stiffens.
[[nodiscard]] Ladder Climb(const ClimbRequest& request);

}  // namespace armcmc::ladder
