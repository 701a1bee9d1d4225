#include "armcmc/rng.hpp"
#include "plants/registry.hpp"
#include "simd/kernels.hpp"

#define ARMCMC_SIMD_NAMESPACE neon
#define ARMCMC_SIMD_LANES 2
#define ARMCMC_SIMD_NEON
#include "simd/kernels.inl"

namespace armcmc::simd {
const Kernels kNeonKernels = {"neon",
                              &neon::Predict,
                              &neon::PredictHalf,
                              &neon::RunStates,
                              &neon::LogLikelihood,
                              &neon::Score,
                              &neon::ScoreTwo,
                              &neon::ExpandPower,
                              &neon::ScoreNear,
                              &neon::QuadraticSums,
                              &neon::QuadraticProducts,
                              &neon::ScoreQuadratic,
                              &neon::AddDensity,
                              &neon::InitialPrior,
                              &neon::ToPhysical,
                              &neon::Uniforms,
                              &neon::UniformsOf,
                              &neon::Choose,
                              &neon::DrawBlock,
                              &neon::FirstMoments,
                              &neon::SecondMoments,
                              &neon::Straighten,
                              &neon::BendMoments,
                              &neon::Histogram,
                              &neon::RelativeLikelihood,
                              &neon::LargestInside,
                              &neon::Weigh,
                              &neon::SharePrior,
                              &neon::Tilt,
                              &neon::Divide,
                              &neon::Ratio,
                              &neon::MoveToEnd,
                              &neon::CountChosen,
                              &neon::Reweigh,
                              &neon::LargestProduct,
                              &neon::Elementary};
}  // namespace armcmc::simd
