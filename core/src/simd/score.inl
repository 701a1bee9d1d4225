// Log-likelihood of candidates; included by kernels.inl, once per instruction set.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

template <std::size_t kTiles>
void ScoreTiles(int model, const NoiseModel& noise, const ModeData& data, const ThetaTile* theta,
                const double* log_scale, PredictionTile* scratch, double* out) noexcept {
  const bool described = data.tape != nullptr;
  const SumSquaresFn sum_squares = data.compiled != nullptr ? PlantTable<AllModels>::kSquares[model](data)
                                   : described              ? nullptr
                                                            : PlantTable<AllModels>::kPlainSquares[model];
  const NoiseSettings& settings = noise.settings();
  const bool gaussian = settings.kind == NoiseKind::kGaussian;
  if (!gaussian && !described && data.compiled == nullptr) {
    for (std::size_t t = 0; t < kTiles; ++t)
      PlantTable<AllModels>::kPlainScoreLaw[model](data, theta[t], noise, log_scale + t * kTileLanes,
                                                   out + t * kTileLanes);
    return;
  }
  const bool summed = described ? settings.mean == 0.0 && data.error_tape != nullptr : sum_squares != nullptr;
  if (!gaussian || !summed) {
    for (std::size_t t = 0; t < kTiles; ++t) {
      Predict(model, data, theta[t], scratch);
      LogLikelihoodBy<ScoreSimd>(noise, data, *scratch, log_scale + t * kTileLanes, out + t * kTileLanes);
    }
    return;
  }
  if (described) {
    SumSquaresOfTapes<kTiles>(data, theta, out);
  } else {
    for (std::size_t t = 0; t < kTiles; ++t) sum_squares(data, theta[t], settings.mean, out + t * kTileLanes);
  }
  const V samples = Simd::Set(static_cast<double>(data.num_samples));
  const V constant = Simd::Set(noise.log_constant());
  for (std::size_t lane = 0; lane < kTiles * kTileLanes; lane += Simd::kLanes) {
    const V log_s = Simd::Load(log_scale + lane);
    const V precision = Simd::Exp2(log_s * Simd::Set(-2.0 * kLog2E));
    Simd::Store(out + lane,
                Simd::Fma(Simd::Set(-0.5) * precision, Simd::Load(out + lane), samples * (constant - log_s)));
  }
}

void ExpandPower(int model, const ModeData& data, const double* middle, const double* reach,
                 PowerSeries* series) noexcept ARMCMC_NONBLOCKING {
  series->parameter = -1;
  if (data.tape == nullptr && data.compiled == nullptr)
    PlantTable<AllModels>::kExpandPower[model](data, middle, reach, series);
}
void ScoreNear(int model, const NoiseModel& noise, const ModeData& data, const PowerSeries* series,
               const ThetaTile& theta, const double* log_scale, int lanes, double* out) noexcept ARMCMC_NONBLOCKING {
  PlantTable<AllModels>::kScoreNear[model](series, data, theta, noise, log_scale, lanes, out);
}

void Score(int model, const NoiseModel& noise, const ModeData& data, const ThetaTile& theta, const double* log_scale,
           PredictionTile* scratch, double* out) noexcept ARMCMC_NONBLOCKING {
  ScoreTiles<1>(model, noise, data, &theta, log_scale, scratch, out);
}
void ScoreTwo(int model, const NoiseModel& noise, const ModeData& data, const ThetaPair& theta, const double* log_scale,
              PredictionTile* scratch, double* out) noexcept ARMCMC_NONBLOCKING {
  ScoreTiles<2>(model, noise, data, theta.data(), log_scale, scratch, out);
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
