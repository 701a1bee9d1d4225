#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "armcmc/gap/adequacy_check.hpp"
#include "armcmc/gap/blocks.hpp"
#include "armcmc/gap/fit.hpp"
#include "armcmc/gap/thresholds.hpp"

namespace armcmc::gap {

/// Flexible correction under which a hypothesis was tested: unnamed physics, a model error of the law, or another
/// effect in its place. Its effects are then named only for their gain beyond the correction.
struct FlexibleCorrection {
  std::string what;
  Fitted without, with;  ///< The correction alone, and with the effects of the hypothesis.
  bool listed = false;   ///< It is an effect of the catalogue.
};

/// A fitted hypothesis with the result of the adequacy check, once computed.
struct Candidate {
  Fitted fit;
  std::optional<Remainder> remainder;
  double probability = 0.0;
  std::size_t num_known = 0;  ///< Leading terms that belong to the model or to the flexible correction.
  std::shared_ptr<FlexibleCorrection> correction;  ///< Null: no correction.

  /// Terms beyond the known ones.
  [[nodiscard]] std::vector<Term> added() const;
  /// Names of the added effects, sorted, as in a verdict.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Families of the added effects, sorted.
  [[nodiscard]] std::vector<std::string> families() const;
  [[nodiscard]] bool exact() const;   ///< All added effects have the catalogue's own formula.
  [[nodiscard]] bool always() const;  ///< All effects act from the first sample to the last, in every mode.
};
using CandidatePtr = std::shared_ptr<Candidate>;

/// Best score first; stable for equal scores.
void SortByScore(std::vector<CandidatePtr>* candidates);

/// Result of the search in one recording with one noise model.
struct Finding {
  Verdict verdict = Verdict::kNone;
  bool approximate = false;  ///< The family is named, but no formula is adequate.
  CandidatePtr base;
  CandidatePtr best;                ///< Best of the set; of all candidates if unnamed; the base if none.
  std::vector<CandidatePtr> set;    ///< Hypotheses that are equally good. Empty unless named or ambiguous.
  CandidatePtr unlisted;            ///< Physics outside the catalogue that explains the gap; null: none does.
  std::vector<double> events_s;     ///< Times of blocks with unexplained events.
  std::vector<CandidatePtr> tried;  ///< Singles and pairs, best held-out score first.
  double gap = 0.0;                 ///< Explainable share of the noise variance beyond the base model.
  double p_missing = 0.0;           ///< Probability that anything is missing.
  double p_none = 1.0;              ///< For the verdict `none`: probability that nothing is missing, however weak.
  double remainder = 0.0;           ///< Share of the noise variance that `best` leaves explainable.
  double p_unnamed = 0.0;           ///< Probability that part of the misfit is not in the catalogue.
};

/// Effects of every hypothesis that remains.
[[nodiscard]] std::set<std::vector<std::string>> NamesOf(const Finding& finding);

/// Withdraws the names of a finding: what is probable, but not adequate, does not explain the data. That no effect of
/// the catalogue explains the misfit then has at least the probability `least`, at the expense of all candidates.
void Withdraw(double least, Finding* finding);

/// The third step: names the missing effects.
class Search {
 public:
  /// @param base  The fitted base model. If its last term is an error of the law, effects are named beside it, as
  ///              beside a flexible correction, and reported without it.
  Search(const Fitter& fitter, const std::vector<EffectForm>& catalogue, const BlockBootstrap& bootstrap,
         const Thresholds& thresholds, Fitted base);

  /// @param pairs  Whether pairs of effects are tested.
  [[nodiscard]] Finding Run(bool pairs) const;
  [[nodiscard]] const AdequacyCheck& adequacy_check() const { return *adequacy_check_; }
  [[nodiscard]] const CandidatePtr& base() const { return base_; }
  /// Whether a hypothesis leaves no significant remainder of a gap of that size.
  [[nodiscard]] bool Adequate(const CandidatePtr& candidate, double gap) const;
  /// Nats that a flexible model gains over a hypothesis: the possible error of its formula.
  [[nodiscard]] double Left(const CandidatePtr& candidate) const { return Judge(candidate).total(); }

 private:
  using Candidates = std::vector<CandidatePtr>;

  /// @param parent  The candidate with the same known terms; null: the base.
  [[nodiscard]] CandidatePtr Make(Fitted fit, const CandidatePtr& parent = nullptr) const;
  /// The parent with one more term, each, on both cores.
  [[nodiscard]] Candidates AddEach(const CandidatePtr& parent, const std::vector<Term>& terms) const;
  /// Of the terms those, at most `count`, that would decrease the sum of squares most.
  [[nodiscard]] std::vector<Term> MostPromising(const CandidatePtr& parent, const std::vector<Term>& terms,
                                                std::size_t count) const;
  [[nodiscard]] Candidates Extend(const CandidatePtr& parent, bool variants) const;
  /// The gated hypotheses with the largest expected gain over the ungated ones, among those active in at least
  /// `min_active` blocks.
  [[nodiscard]] Candidates ExtendGated(const CandidatePtr& parent, const Candidates& always, int min_active) const;
  /// Adds single effects with the onset of the best of `gated`: those of its family, and those whose shape an ungated
  /// fit estimates wrongly, so that a scan with it misses their onset.
  void ShareOnset(int min_active, Candidates* gated) const;
  /// The gated members of the best pairs as single effects, without those already in `singles`.
  [[nodiscard]] Candidates GatedAlone(const Candidates& pairs, const Candidates& singles) const;
  /// The verdict on an effect that acts in one to three events, by evidence, since no block can be left out.
  void JudgeEvents(const Candidates& singles, Finding* finding) const;
  /// Changes the verdict to unnamed if a few events remain unexplained and it is certain that something is missing.
  void CheckUnexplainedEvents(const Candidates& singles, Finding* finding) const;
  /// @param parent  A candidate whose pairs have been computed (`extended`); may be null.
  [[nodiscard]] Candidates Pairs(const Candidates& order, const CandidatePtr& parent, const Candidates& extended) const;
  /// Single effects in combination with a flexible correction: that of `unlisted`, or the model error of the law,
  /// whichever adds most to the best of `listed`.
  [[nodiscard]] Candidates WithCorrection(const Candidates& listed, const Candidates& unlisted) const;
  /// Whether an effect is confirmed although it leaves a remainder even with a flexible correction: it closes most of
  /// the gap, and no effect of another family has a similar gain beyond the correction.
  [[nodiscard]] bool StandsOut(const CandidatePtr& candidate, const Candidates& corrected) const;
  /// The law with its smooth model error; null: the equation has none.
  [[nodiscard]] CandidatePtr LawError() const;
  /// Removes hypotheses with a flexible correction if one without it is better, or if their families are not in all of
  /// the equally good hypotheses.
  void DropUncertain(Candidates* good) const;
  /// Refits the hypotheses of a verdict without their flexible correction: that is the model that is reported.
  void RemoveCorrections(Finding* finding) const;
  /// The search where the base model has an error of the law: single effects that stand out beside it.
  [[nodiscard]] Finding BesideLawError() const;
  [[nodiscard]] Candidates Listed(const Candidates& candidates, bool listed) const;
  [[nodiscard]] bool IsBeatenBy(const CandidatePtr& named, const CandidatePtr& unlisted) const;
  [[nodiscard]] CandidatePtr Refined(const CandidatePtr& pair) const;
  /// The same effects with the catalogue's formulas and without gates.
  [[nodiscard]] CandidatePtr Ungated(const CandidatePtr& pair) const;
  [[nodiscard]] const Remainder& Judge(const CandidatePtr& candidate) const;
  [[nodiscard]] bool Better(const Fitted& a, const Fitted& b) const;
  /// Difference in nats below which two hypotheses are tied, in a gap of that size.
  /// @param kin  Both are of the same family, with similar formula errors.
  [[nodiscard]] double Margin(double gap, bool kin) const;
  /// Where the verdict is pairs of effects, all of which have one that explains nearly all by itself, names only that:
  /// the other may stand in for an error of the law. Not where the equation has a model error of its law, which then is
  /// a rival (WithCorrection).
  void DropSmallSecond(Finding* finding) const;
  /// Widens an uncertain name to a set, or withdraws it.
  void WidenOrWithdraw(Finding* finding) const;
  /// Withdraws a name or a set with a probability below Thresholds::doubt; a single name with a flexible correction, or
  /// of several effects, below Thresholds::sure.
  void WithdrawImprobable(Finding* finding) const;
  [[nodiscard]] Candidates Near(const Candidates& sorted, double gap) const;
  [[nodiscard]] double Gain(const CandidatePtr& candidate) const;
  [[nodiscard]] double Closure(const CandidatePtr& candidate) const;
  void AssignProbabilities(Finding* finding) const;
  /// ln of the Bayes factor of a single effect over no effect. The prior of its size R (rms relative to the noise) is
  /// log-uniform up to Thresholds::largest_ratio.
  [[nodiscard]] double LogOdds(const CandidatePtr& candidate) const;
  /// Rms of the change of the prediction by a hypothesis, relative to the noise.
  [[nodiscard]] double Ratio(const CandidatePtr& candidate) const;
  /// Probability that nothing is missing, from LogOdds of every effect, with a prior of one half. Sets the
  /// probabilities of the effects.
  double ProbabilityOfNone(const Candidates& singles) const;
  /// The same for the law with a smooth error of any size: R is that of a random error, its shares normally
  /// distributed.
  [[nodiscard]] double LogOddsOfLawError(const CandidatePtr& law) const;
  /// Where nothing is named, an error in the formula of the law is as probable beforehand as a family of effects.
  void AllowForLawError(Finding* finding) const;
  [[nodiscard]] bool FamilyHolds(const CandidatePtr& best, const Candidates& singles) const;
  [[nodiscard]] Candidates OnePerName(const Candidates& candidates) const;
  /// Removes variant formulas from equally good hypotheses if the catalogue's own formula is among them.
  static void PreferCatalogue(Candidates* good);

  const Fitter* fitter_;
  const std::vector<EffectForm>* catalogue_;
  const BlockBootstrap* bootstrap_;
  Thresholds limits_;
  std::unique_ptr<AdequacyCheck> adequacy_check_;
  CandidatePtr base_;
  bool law_errs_ = false;  ///< The base model has an error of the law.
  double rows_ = 0.0;
};

}  // namespace armcmc::gap
