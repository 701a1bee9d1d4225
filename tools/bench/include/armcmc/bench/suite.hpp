#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "armcmc/bench/workload.hpp"

namespace armcmc::bench {

/// What is to be measured.
struct Suite {
  std::vector<Plant> plants;
  std::vector<int> draws;    ///< Of BM_AdjustStep; 0: as many as the default rule wants.
  std::vector<int> samples;  ///< Samples of a pack.
  bool quality = true;       ///< Also the effective number of draws, which takes a minute.
};

/// The suite for the plants that are known, or those that are named.
/// @throws ConfigError for a model that is neither built in nor a file nor a plant that came along.
[[nodiscard]] Suite MakeSuite(const std::vector<std::string>& models);

/// Registers the benchmarks of a suite with Google Benchmark:
///
///   BM_AdjustStep/PLANT/DRAWS/SAMPLES      draw and remember: what the adjust stage computes in a period
///   BM_Draw, BM_Remember, BM_Execute       its parts, and the execute stage; same arguments
///   BM_Dimension/PARAMETERS                draw and remember with laws of 2 to 6 parameters (law_family.hpp)
///   BM_Memory/PLANT                        construction; the counter `bytes` is the heap that it takes
///   BM_Score/PLANT                         the likelihood of all candidates alone, sample by sample
///   BM_Noise/PLANT/LAW                     draw, execute and remember under another law of the noise
///   BM_Effects/PLANT/COUNT                 the same with effects added to the law
///   BM_NaiveLoop/DRAWS/SAMPLES             the likelihood of the contact as a plain scalar loop with std::pow
///   BM_EffectiveDraws/CASE                 draws against quadrature; counters are effective numbers of draws
///
/// @param folder  For simulated data, which are read before this returns.
/// @throws std::runtime_error when a plant cannot be simulated.
void Register(const Suite& suite, const std::filesystem::path& folder);

}  // namespace armcmc::bench
