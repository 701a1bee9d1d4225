#pragma once

#include "armcmc/bench/suite.hpp"

namespace armcmc::bench {

/// BM_AdjustStep, BM_Draw, BM_Remember, BM_Execute of one plant.
void RegisterSteps(const Plant& plant, int draws, int samples, const std::filesystem::path& folder);
/// BM_Dimension: draw and remember with laws of 2 to 6 parameters, default number of draws, 100 samples.
void RegisterDimensions();
/// BM_AdjustStep without the short cut of laws that are linear in all parameters but one or two.
void RegisterEverySample(const Plant& plant, int samples, const std::filesystem::path& folder);
/// BM_Score: the likelihood alone of the default number of candidates, sample by sample, 100 samples. Of a plant
/// without effects.
void RegisterScore(const Plant& plant, const std::filesystem::path& folder);
/// BM_Memory: heap of an estimator with one result slot, all of it allocated at construction.
void RegisterMemory(const Plant& plant);
/// BM_Noise: one for each law.
void RegisterNoise(const Plant& plant, const std::filesystem::path& folder);
/// BM_Effects: none, one, two, three. Of a built-in plant that has so many effects with additive amplitudes.
void RegisterEffects(const Plant& plant, const std::filesystem::path& folder);
/// BM_NaiveLoop.
void RegisterNaiveLoop(int draws, int samples);
/// BM_EffectiveDraws: cold, warm, ridge, change.
void RegisterQuality();

}  // namespace armcmc::bench
