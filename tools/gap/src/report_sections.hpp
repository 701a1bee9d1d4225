#pragma once

#include "armcmc/gap/result.hpp"
#include "armcmc/plots/page.hpp"

// The parts of the report, in the order of the page. Each appends to it, or nothing when there is nothing to say.
namespace armcmc::gap {

/// Whether the result describes a model with effects added, so that there is an "after".
[[nodiscard]] bool HasAfter(const Result& result);

/// Tints what had no part in the diagnosis, when it is the end of the same recording.
void ShadeHeldOut(const Figures& figures, plots::XyChart* chart);

/// Verdict, probability, what follows from it.
void AddHeadline(const Result& result, plots::Page* page);
/// What was named, rung by rung, and what is left.
void AddLadder(const Result& result, plots::Page* page);
/// Gap before and after beside what was added.
void AddGapAndEffects(const Result& result, plots::Page* page);
/// What is ambiguous, and the experiment that would separate it.
void AddOpenQuestions(const Result& result, plots::Page* page);
/// Curves against time.
void AddTimeFigures(const Result& result, plots::Page* page);
/// What the estimator made of the recording as it went by: one-step prediction, drift of the parameters.
void AddRunAlong(const Result& result, plots::Page* page);
/// Residual against each feature.
void AddFeatureFigures(const Result& result, plots::Page* page);
/// Map and table of where model and data disagree.
void AddWhere(const Result& result, plots::Page* page);
/// Spectrum of the residual.
void AddSpectrum(const Result& result, plots::Page* page);
/// Every explanation that was weighed.
void AddCandidates(const Result& result, plots::Page* page);
/// Parameters of the base model before and after.
void AddParameters(const Result& result, plots::Page* page);
/// Errors, coverage, whiteness, regimes.
void AddQuality(const Result& result, plots::Page* page);
/// Step time, limits, notes.
void AddLimits(const Result& result, plots::Page* page);
/// What the result was made from.
void AddProvenance(const Result& result, plots::Page* page);

}  // namespace armcmc::gap
