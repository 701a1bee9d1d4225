#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "armcmc/gap/blocks.hpp"
#include "armcmc/gap/fit.hpp"
#include "armcmc/gap/referee.hpp"
#include "armcmc/gap/thresholds.hpp"

namespace armcmc::gap {

/// What was granted to a hypothesis while it was judged: physics without a name, or that the law is not quite its
/// formula. A name is then earned by what the effects add to that.
struct Granted {
  std::string what;
  Fitted without, with;  ///< The grant alone, and with the effects of the hypothesis.
};

/// A fitted hypothesis with what the referee says of it, once asked.
struct Candidate {
  Fitted fit;
  std::optional<Remainder> remainder;
  double probability = 0.0;
  std::size_t num_known = 0;         ///< Leading terms that the model had before, or that are granted.
  std::shared_ptr<Granted> granted;  ///< Null: nothing.

  /// Terms beyond those of the model.
  [[nodiscard]] std::vector<Term> added() const;
  /// Added effects by name, sorted: what a verdict calls it.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Families of the added effects, sorted.
  [[nodiscard]] std::vector<std::string> families() const;
  [[nodiscard]] bool exact() const;   ///< Every added effect by the catalogue's own formula.
  [[nodiscard]] bool always() const;  ///< Every effect from the first sample to the last, in every mode.
};
using CandidatePtr = std::shared_ptr<Candidate>;

/// Best score first; equal ones as they come.
void SortByScore(std::vector<CandidatePtr>* candidates);

/// What the search finds in one recording with one noise model.
struct Finding {
  Verdict verdict = Verdict::kNone;
  bool approximate = false;  ///< The family is named, no formula is adequate.
  CandidatePtr base;
  CandidatePtr best;                ///< Of the set; of all candidates where nothing is named; base for none.
  std::vector<CandidatePtr> set;    ///< Hypotheses that are equally good. Empty unless named or ambiguous.
  CandidatePtr unlisted;            ///< Physics outside the catalogue that explains the gap; null: none does.
  std::vector<double> events_s;     ///< Times of blocks that stand out and that nothing explains.
  std::vector<CandidatePtr> tried;  ///< Singles and pairs, best held-out score first.
  double gap = 0.0;                 ///< Explainable share of the noise variance beyond the base model.
  double p_missing = 0.0;           ///< That anything is missing.
  double p_none = 1.0;              ///< Of a verdict of none: that nothing is missing, however weak.
  double remainder = 0.0;           ///< Share of the noise variance that `best` leaves explainable.
  double p_unnamed = 0.0;           ///< Of what is missing: that `best` leaves some, or that it has no name.
};

/// Effects of every hypothesis that remains.
[[nodiscard]] std::set<std::vector<std::string>> NamesOf(const Finding& finding);

/// The third step: names what is missing.
class Search {
 public:
  /// @param base  The model as it is, fitted.
  Search(const Fitter& fitter, const std::vector<EffectForm>& catalogue, const BlockBootstrap& bootstrap,
         const Thresholds& thresholds, Fitted base);

  /// @param pairs  Whether two effects at once are tried.
  [[nodiscard]] Finding Run(bool pairs) const;
  [[nodiscard]] const Referee& referee() const { return *referee_; }
  [[nodiscard]] const CandidatePtr& base() const { return base_; }
  /// Whether a hypothesis leaves nothing worth another name, of a gap of that size.
  [[nodiscard]] bool Adequate(const CandidatePtr& candidate, double gap) const;
  /// Nats that a flexible model still finds after a hypothesis: what its formula may err by.
  [[nodiscard]] double Left(const CandidatePtr& candidate) const { return Judge(candidate).total(); }

 private:
  using Candidates = std::vector<CandidatePtr>;

  /// @param parent  Whose known terms it shares; null: the base.
  [[nodiscard]] CandidatePtr Make(Fitted fit, const CandidatePtr& parent = nullptr) const;
  /// The parent with one more term, each, on both cores.
  [[nodiscard]] Candidates AddEach(const CandidatePtr& parent, const std::vector<Term>& terms) const;
  [[nodiscard]] Candidates Extend(const CandidatePtr& parent, bool variants) const;
  /// Gated hypotheses whose gates leave at least so many blocks active and promise most over the ungated ones.
  [[nodiscard]] Candidates ExtendGated(const CandidatePtr& parent, const Candidates& always, int min_active) const;
  /// Adds single effects that may begin when the best of `gated` does: those of its family, and those whose shape an
  /// ungated fit gets wrong, so that no scan with it finds their onset.
  void ShareOnset(int min_active, Candidates* gated) const;
  /// The gated members of the best pairs, alone, that `singles` does not hold.
  [[nodiscard]] Candidates GatedAlone(const Candidates& pairs, const Candidates& singles) const;
  /// The verdict on what shows in one to three events, by evidence: nothing can be left out.
  void JudgeEvents(const Candidates& singles, Finding* finding) const;
  /// Where a few events stand out that nothing explains, and "nothing is missing" is out of the question: unnamed.
  void DoubtNothing(const Candidates& singles, Finding* finding) const;
  /// @param parent  One whose partners are known already, `extended`; may be null.
  [[nodiscard]] Candidates Pairs(const Candidates& order, const CandidatePtr& parent, const Candidates& extended) const;
  /// Single effects beside physics without a name: that of `unlisted`, or the law's own error, which adds most to the
  /// best of `listed`.
  [[nodiscard]] Candidates Beside(const Candidates& listed, const Candidates& unlisted) const;
  /// Whether an effect beside a grant that leaves something all the same is really there: it closes most of the gap,
  /// and what it gains beyond the grant no effect of another family comes near to.
  [[nodiscard]] bool StandsOut(const CandidatePtr& candidate, const Candidates& beside) const;
  /// The law with a smooth error of its own; null: the equation knows none.
  [[nodiscard]] CandidatePtr LawError() const;
  /// Leaves out hypotheses with a grant unless all of the equally good ones hold their families, and where one of them
  /// without a grant does better.
  void DropUnsure(Candidates* good) const;
  /// Of hypotheses with a grant those that a verdict tells of, fitted without it: that is the model that they add up
  /// to.
  void TakeBack(Finding* finding) const;
  [[nodiscard]] Candidates Listed(const Candidates& candidates, bool listed) const;
  [[nodiscard]] bool Outdone(const CandidatePtr& named, const CandidatePtr& unlisted) const;
  [[nodiscard]] CandidatePtr Refined(const CandidatePtr& pair) const;
  /// The catalogue's formulas of the same effects, from the first sample to the last.
  [[nodiscard]] CandidatePtr Ungated(const CandidatePtr& pair) const;
  [[nodiscard]] const Remainder& Judge(const CandidatePtr& candidate) const;
  [[nodiscard]] bool Better(const Fitted& a, const Fitted& b) const;
  /// Nats below which a lead decides nothing, in a gap of that size.
  /// @param kin  Both are of the same family: their formulas err alike.
  [[nodiscard]] double Margin(double gap, bool kin) const;
  /// A name that is not sure becomes a set, or none.
  void Hedge(Finding* finding) const;
  /// What is less probable than not gets no name, be it a set.
  void Doubt(Finding* finding) const;
  [[nodiscard]] Candidates Near(const Candidates& sorted, double gap) const;
  [[nodiscard]] double Gain(const CandidatePtr& candidate) const;
  [[nodiscard]] double Closure(const CandidatePtr& candidate) const;
  void AssignProbabilities(Finding* finding) const;
  /// ln of the Bayes factor of a single effect over nothing. Its size R, rms over noise, is as probable in one decade
  /// as in another, from what nobody would miss to Thresholds::largest_ratio.
  [[nodiscard]] double LogOdds(const CandidatePtr& candidate) const;
  /// Rms of what a hypothesis changes in the prediction over that of the noise.
  [[nodiscard]] double Ratio(const CandidatePtr& candidate) const;
  /// Probability that nothing is missing, by LogOdds of every effect, nothing and something being equally probable
  /// beforehand. Gives the effects theirs.
  double WeighNothing(const Candidates& singles) const;
  [[nodiscard]] bool FamilyHolds(const CandidatePtr& best, const Candidates& singles) const;
  [[nodiscard]] Candidates OnePerName(const Candidates& candidates) const;
  /// Leaves out of equally good hypotheses the formulas that need not be there.
  static void PreferCatalogue(Candidates* good);

  const Fitter* fitter_;
  const std::vector<EffectForm>* catalogue_;
  const BlockBootstrap* bootstrap_;
  Thresholds limits_;
  std::unique_ptr<Referee> referee_;
  CandidatePtr base_;
  double rows_ = 0.0;
};

}  // namespace armcmc::gap
