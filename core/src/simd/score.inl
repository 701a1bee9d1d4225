// Log-likelihood of candidates; included by kernels.inl, once per instruction set.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

void Score(int model, const NoiseModel& noise, const ModeData& data, const ThetaTile& theta, const double* log_scale,
           PredictionTile* scratch, double* out) noexcept ARMCMC_NONBLOCKING {
  const SumSquaresFn sum_squares = data.compiled != nullptr ? PlantTable<AllModels>::kSquares[model](data)
                                   : data.tape != nullptr   ? &SumSquaresTape
                                                            : PlantTable<AllModels>::kPlainSquares[model];
  if (noise.settings().kind != NoiseKind::kGaussian || sum_squares == nullptr ||
      (data.tape != nullptr && noise.settings().mean != 0.0)) {
    Predict(model, data, theta, scratch);
    LogLikelihood(noise, data, *scratch, log_scale, out);
    return;
  }
  sum_squares(data, theta, noise.settings().mean, out);
  const V samples = Simd::Set(static_cast<double>(data.num_samples));
  const V constant = Simd::Set(noise.log_constant());
  for (int lane = 0; lane < kTileLanes; lane += Simd::kLanes) {
    const V log_s = Simd::Load(log_scale + lane);
    const V precision = Simd::Exp2(log_s * Simd::Set(-2.0 * kLog2E));
    Simd::Store(out + lane,
                Simd::Fma(Simd::Set(-0.5) * precision, Simd::Load(out + lane), samples * (constant - log_s)));
  }
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
