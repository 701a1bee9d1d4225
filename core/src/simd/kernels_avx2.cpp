#include "armcmc/rng.hpp"
#include "plants/registry.hpp"
#include "simd/kernels.hpp"

#define ARMCMC_SIMD_NAMESPACE avx2
#define ARMCMC_SIMD_LANES 4
#include "simd/kernels.inl"

namespace armcmc::simd {
const Kernels kAvx2Kernels = {"avx2",
                              &avx2::Predict,
                              &avx2::PredictHalf,
                              &avx2::RunStates,
                              &avx2::LogLikelihood,
                              &avx2::Score,
                              &avx2::ScoreTwo,
                              &avx2::ExpandPower,
                              &avx2::ScoreNear,
                              &avx2::QuadraticSums,
                              &avx2::QuadraticProducts,
                              &avx2::ScoreQuadratic,
                              &avx2::AddDensity,
                              &avx2::InitialPrior,
                              &avx2::ToPhysical,
                              &avx2::Uniforms,
                              &avx2::UniformsOf,
                              &avx2::Choose,
                              &avx2::DrawBlock,
                              &avx2::FirstMoments,
                              &avx2::SecondMoments,
                              &avx2::Straighten,
                              &avx2::BendMoments,
                              &avx2::Histogram,
                              &avx2::RelativeLikelihood,
                              &avx2::LargestInside,
                              &avx2::Weigh,
                              &avx2::SharePrior,
                              &avx2::Tilt,
                              &avx2::Divide,
                              &avx2::Ratio,
                              &avx2::MoveToEnd,
                              &avx2::CountChosen,
                              &avx2::Reweigh,
                              &avx2::LargestProduct,
                              &avx2::Elementary};
}  // namespace armcmc::simd
