#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <vector>

#include "armcmc/models/compiled_plant.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/parameter_space.hpp"
#include "armcmc/plant/program.hpp"
#include "armcmc/rng.hpp"
#include "armcmc/sample_size.hpp"
#include "simd/kernels.hpp"
#include "steps.hpp"

namespace armcmc::bench {
namespace {

/// Candidates of one mode, scored sample by sample as the sampler does where no short cut applies.
class Scored {
 public:
  Scored(const EstimatorSettings& settings, const DataPack& pack)
      : info_(settings.plant != nullptr ? settings.plant->info()
                                        : *CompiledModels()[static_cast<std::size_t>(FindModel(settings.model))]),
        model_(settings.plant != nullptr ? -1 : FindModel(settings.model)) {
    int mode = 0;
    while (!Prepare(settings, pack, mode))
      if (++mode == info_.num_modes) throw std::runtime_error("no mode has every sample of the pack");
    data_->weight.fill(1.0);
    data_->weighted = false;
    const NoiseSettings& noise = settings.noise[static_cast<std::size_t>(mode)];
    space_ = ParameterSpace(settings, noise);
    noise_ = std::make_unique<const NoiseModel>(noise);
    const int draws = ChernoffDraws(settings.sampler.epsilon, settings.sampler.delta);
    const RandomStream stream(1, 0, 0);
    for (int d = 0; d < space_.dim; ++d) {
      const auto i = static_cast<std::size_t>(d);
      u_[i].resize(static_cast<std::size_t>(RoundUpToTile(draws) + kTileLanes));
      kernels_.uniforms(stream.origin(), static_cast<std::uint64_t>(d) * u_[i].size(), 1,
                        static_cast<int>(u_[i].size()), u_[i].data());
      for (double& u : u_[i]) u = std::clamp(2.0 * u - 1.0, space_.lower[i], space_.upper[i]);  // near the prior's mean
      rows_[i] = u_[i].data();
    }
    log_likelihood_.resize(u_[0].size());
  }

  void Run() {
    alignas(64) std::array<double, 2 * kTileLanes> log_scale;
    for (std::size_t k = 0; k + 2 * kTileLanes <= log_likelihood_.size(); k += 2 * kTileLanes) {
      const int first = static_cast<int>(k);
      kernels_.to_physical(space_, rows_.data(), first, &work_->theta[0], log_scale.data());
      kernels_.to_physical(space_, rows_.data(), first + kTileLanes, &work_->theta[1], log_scale.data() + kTileLanes);
      kernels_.score_two(model_, *noise_, *data_, work_->theta, log_scale.data(), &work_->prediction,
                         &log_likelihood_[k]);
    }
    benchmark::DoNotOptimize(log_likelihood_.data());
  }

 private:
  struct Work {
    ThetaPair theta;
    PredictionTile prediction;
  };

  /// @return false where another mode has some of the samples.
  bool Prepare(const EstimatorSettings& settings, const DataPack& pack, int mode) {
    if (settings.plant == nullptr) {
      info_.compiled->prepare(pack, settings.constants, mode, data_.get());
    } else {
      expression::FeatureMemory memory;
      memory.Clear();
      if (!settings.plant->Prepare(pack, &memory, nullptr, described_.get()))
        throw std::runtime_error("a pack was refused");
      settings.plant->Fill(*described_, pack.num_samples, mode, data_.get());
    }
    return data_->num_samples == pack.num_samples;
  }

  const ModelInfo& info_;
  const int model_;
  const simd::Kernels& kernels_ = simd::Best();
  std::unique_ptr<ModeData> data_ = std::make_unique<ModeData>();
  std::unique_ptr<PlantPack> described_ = std::make_unique<PlantPack>();  ///< Of a plant file: data_ points into it.
  ParameterSpace space_;
  std::unique_ptr<const NoiseModel> noise_;
  std::array<std::vector<double>, kMaxParams> u_;
  std::array<const double*, kMaxParams> rows_{};
  std::vector<double> log_likelihood_;
  std::unique_ptr<Work> work_ = std::make_unique<Work>();
};

}  // namespace

void RegisterScore(const Plant& plant, const std::filesystem::path& folder) {
  constexpr int kSamples = 100;
  const EstimatorSettings settings = SettingsOf(plant);
  const DataPack pack = FullPacks(plant, kSamples, folder).front();
  benchmark::RegisterBenchmark(("BM_Score/" + plant.name).c_str(), [settings, pack](benchmark::State& state) {
    Scored scored(settings, pack);
    for (auto _ : state) scored.Run();
  })->Unit(benchmark::kMillisecond);
}

}  // namespace armcmc::bench
