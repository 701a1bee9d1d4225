#include "armcmc/gap/diagnose.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "armcmc/gap/band_noise.hpp"
#include "armcmc/gap/smoothing.hpp"

namespace armcmc::gap {
namespace {

constexpr int kWidestWindow = 15;
constexpr int kNoisePasses = 2, kSearchPasses = 4;
constexpr int kBaseSteps = 30;
constexpr int kLawErrorPlaces = 8;  // along each variable of a law that may err
constexpr double kCleaner = 0.97;   // of the innovation variance, below which the first noise model hid an effect

/// Noise model from what a hypothesis and the flexible model leave together. Where the law may err, what they leave in
/// its band is not noise alone.
/// @param predicted  By the law.
Whitener NoiseLeftBy(const Fitter& fitter, const Remainder& remainder, const Vector& predicted, bool law_errs) {
  const Vector left = fitter.whitener().Colour(remainder.unexplained);
  const std::optional<Whitener> above = law_errs ? NoiseAboveBand(left, predicted) : std::nullopt;
  return above ? *above : FitNoise(left);
}

/// The model without additions, with the effects that it already has, and with the error of a law that may err.
Fitted FitModel(const Fitter& fitter, const std::vector<EffectForm>& catalogue, const DiagnoseOptions& options) {
  Fitted fit = fitter.Fit({}, fitter.equation().Start(fitter.signals()), kBaseSteps);
  for (const auto& [effect, when] : options.known) {
    const auto form = std::find_if(catalogue.begin(), catalogue.end(),
                                   [&, name = effect](const EffectForm& f) { return f.exact() && f.effect == name; });
    if (form == catalogue.end()) throw std::invalid_argument("the workflow knows no effect called " + effect);
    fit = fitter.Add(fit, {&*form, when});
  }
  if (options.law_errs)
    for (const EffectForm& form : catalogue)
      if (form.regular) fit = fitter.Add(fit, {&form, {}});
  return fit;
}

/// What the motion allows.
int WideWindow(const Equation& equation, const Recording& recording) {
  int window = kWidestWindow;
  for (const std::string& column : equation.smoothed_columns())
    window = std::min(window, WidestWindow(recording.Column(column), kWidestWindow));
  return window;
}

/// About half as wide, odd.
int NarrowWindow(int wide) { return wide / 2 < 5 ? 1 : wide / 2 / 2 * 2 + 1; }

/// Takes effects out of a catalogue. A plain error stays as a rival that is not named.
void Exclude(const std::vector<std::string>& without, std::vector<EffectForm>* catalogue) {
  const auto excluded = [&](const EffectForm& form) {
    return std::find(without.begin(), without.end(), form.effect) != without.end();
  };
  std::erase_if(*catalogue, [&](const EffectForm& form) { return excluded(form) && form.plain_error.empty(); });
  for (EffectForm& form : *catalogue) {
    if (!excluded(form)) continue;
    form.listed = false;
    form.effect = form.family = form.plain_error;
  }
}

/// @return an analysis without a finding if the law is to err and its equation has no error.
std::unique_ptr<Analysis> Analyse(const Equation& equation, const Recording& recording, int window,
                                  const DiagnoseOptions& options, const BlockBootstrap& bootstrap) {
  auto analysis = std::make_unique<Analysis>();
  analysis->signals = equation.Prepare(recording, window);
  analysis->signals.window = window;
  analysis->catalogue = equation.Catalogue(analysis->signals);
  Exclude(options.without, &analysis->catalogue);
  if (options.law_errs) {
    std::erase_if(analysis->catalogue, [](const EffectForm& form) { return form.regular; });
    std::optional<EffectForm> error = equation.LawError(analysis->signals, kLawErrorPlaces);
    if (!error) return analysis;
    analysis->catalogue.push_back(*std::move(error));
  }
  Whitener whitener;
  for (int pass = 0; pass < kNoisePasses; ++pass) {
    const Fitter fitter(equation, analysis->signals, whitener);
    const Fitted base = FitModel(fitter, analysis->catalogue, options);
    const Remainder left = AdequacyCheck(fitter, base.predicted).Judge(base);
    whitener = NoiseLeftBy(fitter, left, base.predicted, options.law_errs);
  }
  // What no additive basis expresses (an onset, a clipped force) hides in the first noise model.
  for (int pass = 0; pass < kSearchPasses; ++pass) {
    analysis->fitter = std::make_unique<Fitter>(equation, analysis->signals, whitener);
    analysis->search = std::make_unique<Search>(*analysis->fitter, analysis->catalogue, bootstrap, options.thresholds,
                                                FitModel(*analysis->fitter, analysis->catalogue, options));
    analysis->finding = analysis->search->Run(options.pairs);
    if (analysis->finding.verdict == Verdict::kNone || !analysis->finding.best->remainder) break;
    const Whitener cleaner = NoiseLeftBy(*analysis->fitter, *analysis->finding.best->remainder,
                                         analysis->finding.base->fit.predicted, options.law_errs);
    if (!(cleaner.variance < kCleaner * whitener.variance)) break;
    whitener = cleaner;
  }
  return analysis;
}

bool Names(const Finding& finding) {
  return finding.verdict == Verdict::kNamed || finding.verdict == Verdict::kAmbiguous;
}

/// The same hypothesis with its scores counted from another base, as those of its analysis are.
CandidatePtr CountedFrom(const Candidate& base, const Candidate& own_base, const Candidate& candidate) {
  auto counted = std::make_shared<Candidate>(candidate);
  counted->fit.log_evidence += base.fit.log_evidence - own_base.fit.log_evidence;
  counted->fit.heldout += base.fit.heldout - own_base.fit.heldout;
  return counted;
}

/// The two analyses are models of the same data with equal prior probability: their results are averaged.
void MeanProbabilities(const Finding& other, Finding* finding) {
  std::map<std::vector<std::string>, double> mean;
  for (const CandidatePtr& candidate : finding->tried) mean[candidate->names()] += 0.5 * candidate->probability;
  for (const CandidatePtr& candidate : other.tried) mean[candidate->names()] += 0.5 * candidate->probability;
  // If the verdict is none, the probabilities of the candidates are those of the weak effects.
  const double other_missing = other.verdict == Verdict::kNone ? 1.0 - other.p_none : other.p_missing;
  const double unnamed = 0.5 * (finding->p_missing * finding->p_unnamed + other_missing * other.p_unnamed);
  finding->p_missing = 0.5 * (finding->p_missing + other_missing);
  finding->p_unnamed = finding->p_missing > 0.0 ? unnamed / finding->p_missing : 0.0;
  for (const CandidatePtr& candidate : finding->tried) candidate->probability = 0.0;
  for (const CandidatePtr& candidate : finding->set)
    if (std::find(finding->tried.begin(), finding->tried.end(), candidate) == finding->tried.end())
      finding->tried.push_back(candidate);
  const auto give = [&](const CandidatePtr& candidate) {
    const auto it = mean.find(candidate->names());
    if (it == mean.end()) return;
    candidate->probability = it->second;
    mean.erase(it);
  };
  for (const CandidatePtr& candidate : finding->set) give(candidate);
  for (const CandidatePtr& candidate : finding->tried) give(candidate);
  for (const CandidatePtr& candidate : other.tried) {
    if (!mean.contains(candidate->names())) continue;
    finding->tried.push_back(CountedFrom(*finding->base, *other.base, *candidate));
    give(finding->tried.back());
  }
  std::stable_sort(finding->tried.begin(), finding->tried.end(),
                   [](const auto& a, const auto& b) { return a->fit.score() > b->fit.score(); });
}

/// Applies the vote of the analysis with the narrower smoother.
/// @param doubt  Probability below which a name is withdrawn.
void Vote(const Finding& other, double doubt, Finding* finding) {
  if (!Names(*finding)) return;
  const auto mine = NamesOf(*finding), theirs = NamesOf(other);
  if (mine == theirs) return;
  if (Names(other)) {
    for (const CandidatePtr& candidate : other.set)
      if (!mine.contains(candidate->names()))
        finding->set.push_back(CountedFrom(*finding->base, *other.base, *candidate));
    MeanProbabilities(other, finding);
    finding->verdict = Verdict::kAmbiguous;
  } else if (finding->approximate || finding->best->added().size() > 1) {
    MeanProbabilities(other, finding);
    Withdraw(1.0 - doubt, finding);
  }
}

}  // namespace

Diagnosis Diagnose(const Equation& equation, const Recording& recording, const DiagnoseOptions& options) {
  Diagnosis diagnosis;
  diagnosis.bootstrap = std::make_unique<BlockBootstrap>(options.seed);
  const int window = WideWindow(equation, recording);
  diagnosis.wide = Analyse(equation, recording, window, options, *diagnosis.bootstrap);
  diagnosis.finding = diagnosis.wide->finding;
  if (Names(diagnosis.finding) && window > 1) {
    diagnosis.narrow = Analyse(equation, recording, NarrowWindow(window), options, *diagnosis.bootstrap);
    Vote(diagnosis.narrow->finding, options.thresholds.doubt, &diagnosis.finding);
  }
  return diagnosis;
}

Diagnosis CompareOnly(const Equation& equation, const Recording& recording, const DiagnoseOptions& options) {
  Diagnosis diagnosis;
  diagnosis.bootstrap = std::make_unique<BlockBootstrap>(options.seed);
  diagnosis.wide = std::make_unique<Analysis>();
  Analysis& analysis = *diagnosis.wide;
  const int window = WideWindow(equation, recording);
  analysis.signals = equation.Prepare(recording, window);
  analysis.signals.window = window;
  Whitener whitener;
  for (int pass = 0; pass < kNoisePasses; ++pass) {
    analysis.fitter = std::make_unique<Fitter>(equation, analysis.signals, whitener);
    analysis.finding.base = std::make_shared<Candidate>();
    analysis.finding.base->fit = analysis.fitter->Fit({}, equation.Start(analysis.signals), 30);
    whitener = FitNoise(whitener.Colour(analysis.finding.base->fit.whitened_residual));
  }
  analysis.fitter = std::make_unique<Fitter>(equation, analysis.signals, whitener);
  analysis.finding.base->fit = analysis.fitter->Fit({}, analysis.finding.base->fit.theta, 30);
  analysis.finding.best = analysis.finding.base;
  diagnosis.finding = analysis.finding;
  return diagnosis;
}

}  // namespace armcmc::gap
