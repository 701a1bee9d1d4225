#pragma once

#include "armcmc/gap/result.hpp"
#include "armcmc/plots/page.hpp"

// The sections of the report, in the order of the page. A section without content appends nothing.
namespace armcmc::gap {

/// Whether the result describes a model with effects added, so that there is an "after".
[[nodiscard]] bool HasAfter(const Result& result);

/// Shades the held-out part, if it is the end of the same recording.
void ShadeHeldOut(const Figures& figures, plots::XyChart* chart);

/// Verdict, probability, consequence.
void AddHeadline(const Result& result, plots::Page* page);
/// The named effects, rung by rung, and the remainder.
void AddLadder(const Result& result, plots::Page* page);
/// Gap before and after, and the added effects.
void AddGapAndEffects(const Result& result, plots::Page* page);
/// The tied effects, and the experiment that would separate them.
void AddOpenQuestions(const Result& result, plots::Page* page);
/// Curves against time.
void AddTimeFigures(const Result& result, plots::Page* page);
/// The estimator run over the recording: one-step prediction, drift of the parameters.
void AddRunAlong(const Result& result, plots::Page* page);
/// Residual against each feature.
void AddFeatureFigures(const Result& result, plots::Page* page);
/// Map and table of where model and data disagree.
void AddWhere(const Result& result, plots::Page* page);
/// Spectrum of the residual.
void AddSpectrum(const Result& result, plots::Page* page);
/// The candidate explanations.
void AddCandidates(const Result& result, plots::Page* page);
/// Parameters of the base model before and after.
void AddParameters(const Result& result, plots::Page* page);
/// Errors, coverage, whiteness, regimes.
void AddQuality(const Result& result, plots::Page* page);
/// Step time, limits, notes.
void AddLimits(const Result& result, plots::Page* page);
/// The data and the program behind the result.
void AddProvenance(const Result& result, plots::Page* page);

}  // namespace armcmc::gap
