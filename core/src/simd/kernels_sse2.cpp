#include "armcmc/rng.hpp"
#include "plants/registry.hpp"
#include "simd/kernels.hpp"

#define ARMCMC_SIMD_NAMESPACE sse2
#define ARMCMC_SIMD_LANES 2
#include "simd/kernels.inl"

namespace armcmc::simd {
const Kernels kSse2Kernels = {"sse2",
                              &sse2::Predict,
                              &sse2::PredictHalf,
                              &sse2::RunStates,
                              &sse2::LogLikelihood,
                              &sse2::Score,
                              &sse2::ScoreTwo,
                              &sse2::QuadraticSums,
                              &sse2::ScoreQuadratic,
                              &sse2::AddDensity,
                              &sse2::InitialPrior,
                              &sse2::ToPhysical,
                              &sse2::Uniforms,
                              &sse2::UniformsOf,
                              &sse2::Choose,
                              &sse2::DrawBlock,
                              &sse2::FirstMoments,
                              &sse2::SecondMoments,
                              &sse2::Straighten,
                              &sse2::BendMoments,
                              &sse2::Histogram,
                              &sse2::RelativeLikelihood,
                              &sse2::LargestInside,
                              &sse2::Weigh,
                              &sse2::SharePrior,
                              &sse2::Divide,
                              &sse2::Ratio,
                              &sse2::CountChosen,
                              &sse2::Reweigh,
                              &sse2::LargestProduct,
                              &sse2::Elementary};
}  // namespace armcmc::simd
