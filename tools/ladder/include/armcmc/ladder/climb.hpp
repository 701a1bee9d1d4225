#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/ladder/candidates.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/free_constants.hpp"
#include "armcmc/ladder/trial.hpp"
#include "armcmc/plant/effect.hpp"

namespace armcmc::ladder {

/// Squared error of one model on left-out rows, divided by that of another, for each kind of row group. 1: no gain.
///
/// For blocks and regions this is the ratio of the sums or the median ratio over the groups, whichever is smaller.
/// Groups that contain nearly all of the evidence for the effect are skipped: when they are left out, the fit cannot
/// show it.
struct Comparison {
  double folds = 1.0, blocks = 1.0, regions = 1.0;
};

/// Another effect that was tried on a rung, and its gain on left-out data.
struct Contender {
  Candidate candidate;
  Trial trial;                ///< Fitted to all training rows if promising, otherwise to the subset of SubsetForFits().
  bool refined = false;       ///< Fitted to all training rows.
  double closed = 0.0;        ///< Share of the base model's squared error that the fit removes, [0, 1].
  Comparison alone;           ///< Relative to the base model, if trial.judged.
  Comparison with_flexible;   ///< The same with the flexible function added to both.
  double gain_share = 0.0;    ///< Share of bootstrap samples of segments in which it gains at least a tenth.
  double win_share = 0.0;     ///< Share in which its family has the smallest error.
  bool larger_part = false;   ///< It removes more than half of the unexplained error.
  bool has_evidence = false;  ///< Rule 1 of Climb(): enough evidence for a name.
  bool ruled_out = false;     ///< Rule 4: a rival outside the catalogue explains more.
  bool ruled_out_with = false;  ///< It is the same, with more parameters, as one that is ruled out.
};

/// A named effect, or several that the data cannot distinguish.
struct Rung {
  std::vector<std::size_t> named;     ///< Indices into `contenders`: the leader, and one of each tied family.
  std::vector<Contender> contenders;  ///< Best first.
  double probability = 0.0;           ///< Probability that an effect of this family is present.
  bool open = false;                  ///< Removes less than half: named only together with the next effect.
  std::string as_if;                  ///< "K followed w by a curve": the rival of the best contender; empty if none.
  bool provisional = false;           ///< Acts in too few separate segments to be validated.
  Trial base;                         ///< The model that the contenders extend.
  View view;                          ///< Rows and groups of the comparison.

  [[nodiscard]] const Contender& leader() const { return contenders[named.front()]; }
};

/// The rungs: effects are named one after the other, until no candidate passes the tests.
struct Ladder {
  std::shared_ptr<const std::vector<EffectEntry>> entries;  ///< Catalogue entries that the candidates point to.
  double noise_floor = 0.0;
  Trial base;                                   ///< The plant without additions.
  std::optional<FreeConstants> free_constants;  ///< Fitted before the first rung, if that is needed to name something.
  std::vector<Rung> rungs;                      ///< In the last one nothing is named.
  std::shared_ptr<const Plant> plant;           ///< With all named effects.
  Trial final_trial;                            ///< Fit of `plant` to all training rows.
  View view;                                    ///< View of the last rung.
  double flexible_gain = 0.0;  ///< Share of the remaining squared error that a flexible function removes.
  bool complete = false;       ///< Only noise remains: see LeavesMore().
  std::vector<std::string> notes;
};

struct ClimbRequest {
  std::shared_ptr<const Plant> plant;
  std::vector<EffectEntry> entries;
  Dataset data;
  /// Standard deviation of the noise, if it cannot be estimated from neighbouring samples because the output was
  /// filtered; otherwise 0.
  double known_noise = 0.0;
  /// Standard deviation of the noise, divided by its estimate from differences of neighbouring samples. Above 1 if
  /// samples were interpolated and therefore share noise.
  double noise_over_differences = 1.0;
  int max_rungs = 5;
  /// Maximum number of rows on which models of a simulated plant are compared.
  std::size_t most_simulated = kMostSimulated;
  std::function<void(const std::string& step, double share)> progress;
};

/// The rules of one rung, applied after every candidate has been fitted:
///
/// 1. Evidence. On left-out data, the effect
///    - removes at least a tenth of the squared error in the folds, in 99 % of the bootstrap samples of their segments
///    (on the first rung also in 95 %, provisionally);
///    - does not increase the error when long blocks or whole regions are left out;
///    - gains also in combination with a flexible function: 5 % in two of the three kinds of groups, or 20 % in one
///    without losing in the others;
///    - removes more than half of the error that is not noise, alone or together with the next effect, unless its
///    family has already been named or only noise remains; and one of its amplitudes is more than two standard
///    deviations from zero;
///    - oscillates, if it is a resonance: its damping ratio is below the limit beyond which nothing resonates;
///    - leaves less than the output varies.
/// 2. Simplest first. Among the candidates that close at least 95 % of what the best one closes, those with the fewest
///    parameters are kept; among these the best one, or, within 1 % of it, the one that depends on the fewest
///    quantities. What a simple effect leaves is examined on the next rung.
/// 3. Ties. The leader is tied with related effects (`kin`) whose error is less than 1.5 times as large, or smaller
///    both on blocks and on regions, if its own formula is not exact; with kin of as many parameters that gains as much
///    up to a thousandth, which is what integrations of a plant differ by; with a family of as few parameters that wins
///    one bootstrap sample in twenty; and with a larger effect of another family that leaves less than half of the
///    error and is better in every kind of group. Each tied effect is shown in the form that predicts best. What a tie
///    leaves is examined on the next rung if a flexible function of the signals explains more than half of it: an
///    effect is named there only if it passes rule 1 with every tied effect in the model, since its name must not
///    depend on an undecided choice; and with it in the model the tie may be decided. A second tie ends the ladder. A
///    provisional name, or tie, is given only if its families win half of the bootstrap samples; otherwise too many
///    effects explain the same.
/// 4. Unnamed rivals. If more than noise remains, an effect is ruled out by a curve: a part of the law that varies with
///    one quantity, in a shape that no formula of the catalogue has, and leaves less than half of the error, is better
///    on blocks, is no worse on regions, and cannot represent the effect. A curve can represent an effect without
///    memory that is a function of the same quantity in the same equations; or one that reads that quantity, if the
///    curve reproduces the effect's prediction up to a tenth of the squared error that the effect leaves; but never an
///    effect that needs the next one to remove half of the error, because one curve is simpler than two effects. An
///    effect is also ruled out if the unextended model leaves less error on smoother versions of the derived signals,
///    because then the misfit is their noise, or if other values of its constants, up to 5 % away, explain
///    as much, or if the response to its free start values does, so that nothing shows how it responds to the motion.
///    An effect that depends on nothing but time, such as an offset, is ruled out if a parameter that varies with a
///    signal or state by at most a third explains as much: over a narrow range a law that is bent looks like an offset.
///    One at a frequency is also ruled out if a function of the motion predicts more than half of it.
///    Any effect is ruled out if a law whose modes change elsewhere explains as much, or an output whose zero is
///    elsewhere or drifts; and one that remembers, or depends on nothing but time, if a parameter that drifts does.
///    These are no rivals where the catalogue has an effect that does the same, since that competes by its name. And
///    an effect of another family
///    that is smaller than a third of those named before is ruled out if it acts like one of them, or if a curve of a
///    quantity that one of them reads explains as much.
/// 5. Confirmation. A name is withdrawn if the held-out rows show neither half of its gain nor, where noise is most of
///    their error, surely half of the rest, or if the model diverges on them, unless it does not with the next effect.
///    What gains less than 95 % of what an effect so withdrawn gained is not named in its place. A name is also
///    withdrawn if a later rung names the same effect again in the same place, for effects of which two can be pieces
///    of a curve that is neither (two backlashes approximate a hardening spring).
/// 6. Once. If a rung names another formula of the effect that the rung before named, on the same quantities, and it
///    explains as much without that, it takes its place.
///
/// If the first rung names nothing, the constants of the plant may hide an effect: they are a few percent off in most
/// files. If all of them together, each up to 5 % from the file, remove a tenth of the squared error on left-out data,
/// the first rung is repeated with them fitted. An effect that is named then gains beyond what any constants can do.
/// If again nothing is named, the file's values stay.
[[nodiscard]] Ladder Climb(const ClimbRequest& request);

}  // namespace armcmc::ladder
