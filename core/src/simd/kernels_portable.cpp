#include "armcmc/rng.hpp"
#include "plants/registry.hpp"
#include "simd/kernels.hpp"

#define ARMCMC_SIMD_NAMESPACE portable
#define ARMCMC_SIMD_LANES 2
#include "simd/kernels.inl"

namespace armcmc::simd {
namespace {
// Compiled without options for an instruction set.
#if defined(__SSE2__)
constexpr const char* kName = "sse2";
#else
constexpr const char* kName = "portable";
#endif
}  // namespace

const Kernels kPortableKernels = {kName,
                                  &portable::Predict,
                                  &portable::PredictHalf,
                                  &portable::RunStates,
                                  &portable::LogLikelihood,
                                  &portable::Score,
                                  &portable::ScoreTwo,
                                  &portable::ExpandPower,
                                  &portable::ScoreNear,
                                  &portable::QuadraticSums,
                                  &portable::QuadraticProducts,
                                  &portable::ScoreQuadratic,
                                  &portable::AddDensity,
                                  &portable::InitialPrior,
                                  &portable::ToPhysical,
                                  &portable::Uniforms,
                                  &portable::UniformsOf,
                                  &portable::Choose,
                                  &portable::DrawBlock,
                                  &portable::FirstMoments,
                                  &portable::SecondMoments,
                                  &portable::Straighten,
                                  &portable::BendMoments,
                                  &portable::Histogram,
                                  &portable::RelativeLikelihood,
                                  &portable::LargestInside,
                                  &portable::Weigh,
                                  &portable::SharePrior,
                                  &portable::Tilt,
                                  &portable::Divide,
                                  &portable::Ratio,
                                  &portable::MoveToEnd,
                                  &portable::CountChosen,
                                  &portable::Reweigh,
                                  &portable::LargestProduct,
                                  &portable::Elementary};
}  // namespace armcmc::simd
