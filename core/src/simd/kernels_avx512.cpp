#include "armcmc/rng.hpp"
#include "plants/registry.hpp"
#include "simd/kernels.hpp"

#define ARMCMC_SIMD_NAMESPACE avx512
#define ARMCMC_SIMD_LANES 8
#include "simd/kernels.inl"

namespace armcmc::simd {
const Kernels kAvx512Kernels = {"avx512",
                                &avx512::Predict,
                                &avx512::PredictHalf,
                                &avx512::RunStates,
                                &avx512::LogLikelihood,
                                &avx512::Score,
                                &avx512::ScoreTwo,
                                &avx512::ExpandPower,
                                &avx512::ScoreNear,
                                &avx512::QuadraticSums,
                                &avx512::QuadraticProducts,
                                &avx512::ScoreQuadratic,
                                &avx512::AddDensity,
                                &avx512::InitialPrior,
                                &avx512::ToPhysical,
                                &avx512::Uniforms,
                                &avx512::UniformsOf,
                                &avx512::Choose,
                                &avx512::DrawBlock,
                                &avx512::FirstMoments,
                                &avx512::SecondMoments,
                                &avx512::Straighten,
                                &avx512::BendMoments,
                                &avx512::Histogram,
                                &avx512::RelativeLikelihood,
                                &avx512::LargestInside,
                                &avx512::Weigh,
                                &avx512::SharePrior,
                                &avx512::Tilt,
                                &avx512::Divide,
                                &avx512::Ratio,
                                &avx512::MoveToEnd,
                                &avx512::CountChosen,
                                &avx512::Reweigh,
                                &avx512::LargestProduct,
                                &avx512::Elementary};
}  // namespace armcmc::simd
