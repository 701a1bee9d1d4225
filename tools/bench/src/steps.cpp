#include "steps.hpp"

#include <benchmark/benchmark.h>

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/bench/law_family.hpp"
#include "armcmc/effects/effect.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/sample_size.hpp"

namespace armcmc::bench {
namespace {

enum class Part : unsigned char { kAdjust, kDraw, kRemember, kExecute, kAll };

/// An estimator that goes round and round through the packs of a plant.
class Loop {
 public:
  Loop(const EstimatorSettings& settings, std::vector<DataPack> packs)
      : estimator_(settings), result_(estimator_.MakeResult()), packs_(std::move(packs)) {}

  /// One pack. @return seconds that the part took.
  double Step(Part part) {
    const DataPack& pack = packs_[next_++ % packs_.size()];
    const auto start = Now();
    status_ = estimator_.Draw(pack, std::numeric_limits<Nanos>::max(), ClockRef(), result_.get());
    const auto drawn = Now();
    estimator_.Execute(*result_, &estimate_);
    const auto executed = Now();
    estimator_.Remember(ClockRef());
    const auto remembered = Now();
    draws_ = kish_ = 0.0;
    for (const ModeDraws& mode : result_->modes)
      if (mode.updated) {
        draws_ += mode.draws;
        kish_ += mode.kish_ess;
      }
    switch (part) {
      case Part::kAdjust: return Seconds(drawn - start) + Seconds(remembered - executed);
      case Part::kDraw: return Seconds(drawn - start);
      case Part::kRemember: return Seconds(remembered - executed);
      case Part::kExecute: return Seconds(executed - drawn);
      case Part::kAll: break;
    }
    return Seconds(remembered - start);
  }
  [[nodiscard]] bool bad() const { return status_ == Status::kBadPack || status_ == Status::kNonFinite; }
  [[nodiscard]] double draws() const { return draws_; }
  [[nodiscard]] double kish() const { return kish_; }

 private:
  using Clock = std::chrono::steady_clock;
  static Clock::time_point Now() { return Clock::now(); }
  static double Seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

  Estimator estimator_;
  std::unique_ptr<AdjustResult> result_;
  Estimate estimate_;
  std::vector<DataPack> packs_;
  std::size_t next_ = 0;
  Status status_ = Status::kOk;
  double draws_ = 0.0, kish_ = 0.0;
};

/// The same data for every benchmark of one plant and length.
using Packs = std::shared_ptr<const std::vector<DataPack>>;

void Run(benchmark::State& state, const EstimatorSettings& settings, const std::vector<DataPack>& packs, Part part) {
  Loop loop(settings, packs);
  for (int warm = 0; warm < 8; ++warm) (void)loop.Step(part);
  double draws = 0.0, kish = 0.0;
  for (auto _ : state) {
    state.SetIterationTime(loop.Step(part));
    if (loop.bad()) {
      state.SkipWithError("a pack was refused");
      break;
    }
    draws += loop.draws();
    kish += loop.kish();
  }
  state.counters["draws"] = benchmark::Counter(draws, benchmark::Counter::kAvgIterations);
  state.counters["kish_ess"] = benchmark::Counter(kish, benchmark::Counter::kAvgIterations);
}

void Add(const std::string& name, EstimatorSettings settings, const Packs& packs, Part part) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [settings = std::move(settings), packs, part](benchmark::State& state) {  // NOLINT
                                 Run(state, settings, *packs, part);
                               })
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

Packs Load(const Plant& plant, int samples, const std::filesystem::path& folder) {
  return std::make_shared<const std::vector<DataPack>>(FullPacks(plant, samples, folder));
}

/// Bytes that malloc has handed out, those of large blocks included.
std::size_t HeapInUse() {
  const struct mallinfo2 info = ::mallinfo2();
  return info.uordblks + info.hblkhd;
}

const ModelInfo* BuiltIn(const EstimatorSettings& settings) {
  return settings.plant != nullptr ? nullptr : CompiledModels()[static_cast<std::size_t>(FindModel(settings.model))];
}

}  // namespace

void RegisterSteps(const Plant& plant, int draws, int samples, const std::filesystem::path& folder) {
  EstimatorSettings settings = SettingsOf(plant);
  if (draws > 0) {
    settings.sampler.rule = DrawRule::kFixed;
    settings.sampler.fixed_draws = draws;
    settings.sampler.max_draws = std::max(settings.sampler.max_draws, draws);
  } else {
    draws = ChernoffDraws(settings.sampler.epsilon, settings.sampler.delta);
  }
  const Packs packs = Load(plant, samples, folder);
  const std::string of = "/" + plant.name + "/" + std::to_string(draws) + "/" + std::to_string(samples);
  Add("BM_AdjustStep" + of, settings, packs, Part::kAdjust);
  Add("BM_Draw" + of, settings, packs, Part::kDraw);
  Add("BM_Remember" + of, settings, packs, Part::kRemember);
  Add("BM_Execute" + of, settings, packs, Part::kExecute);
}

void RegisterDimensions() {
  constexpr int kPacks = 32, kSamples = 100;
  for (int d = kFewestLawParameters; d <= kMostLawParameters; ++d) {
    const EstimatorSettings settings = LawSettings(d);
    Add("BM_Dimension/" + std::to_string(d), settings,
        std::make_shared<const std::vector<DataPack>>(LawPacks(d, settings, kPacks, kSamples)), Part::kAdjust);
  }
}

void RegisterEverySample(const Plant& plant, int samples, const std::filesystem::path& folder) {
  EstimatorSettings settings = SettingsOf(plant);
  settings.sampler.use_linearity = false;
  const int draws = ChernoffDraws(settings.sampler.epsilon, settings.sampler.delta);
  Add("BM_EverySample/" + plant.name + "/" + std::to_string(draws) + "/" + std::to_string(samples), settings,
      Load(plant, samples, folder), Part::kAdjust);
}

void RegisterMemory(const Plant& plant) {
  benchmark::RegisterBenchmark(("BM_Memory/" + plant.name).c_str(), [settings =
                                                                         SettingsOf(plant)](benchmark::State& state) {
    std::size_t bytes = 0;
    for (auto _ : state) {
      const std::size_t before = HeapInUse();
      const Estimator estimator(settings);
      const auto result = estimator.MakeResult();
      bytes = HeapInUse() - before;
    }
    state.counters["bytes"] =
        benchmark::Counter(static_cast<double>(bytes), benchmark::Counter::kDefaults, benchmark::Counter::kIs1024);
  })->Unit(benchmark::kMillisecond);
}

void RegisterNoise(const Plant& plant, const std::filesystem::path& folder) {
  const Packs packs = Load(plant, 100, folder);
  for (const auto& [kind, law] :
       {std::pair{NoiseKind::kGaussian, "gaussian"}, std::pair{NoiseKind::kStudentT, "student_t"},
        std::pair{NoiseKind::kLaplace, "laplace"}, std::pair{NoiseKind::kMixture, "mixture"}}) {
    EstimatorSettings settings = SettingsOf(plant);
    for (NoiseSettings& noise : settings.noise) noise.kind = kind;
    Add("BM_Noise/" + plant.name + "/" + law, settings, packs, Part::kAll);
  }
}

void RegisterEffects(const Plant& plant, const std::filesystem::path& folder) {
  constexpr int kMost = 3;
  EstimatorSettings settings = SettingsOf(plant);
  const ModelInfo* info = BuiltIn(settings);
  if (info == nullptr) return;
  const Packs packs = Load(plant, 100, folder);
  Add("BM_Effects/" + plant.name + "/0", settings, packs, Part::kAll);
  for (const EffectInfo* effect : info->compiled->effects) {
    if (settings.num_effects == kMost) break;
    EstimatorSettings more = settings;
    more.effects[static_cast<std::size_t>(more.num_effects++)] = MakeEffect(*info, std::string(effect->name));
    try {
      more.Validate();
    } catch (const std::invalid_argument&) {
      continue;  // one that cannot go with those before it
    }
    settings = more;
    Add("BM_Effects/" + plant.name + "/" + std::to_string(settings.num_effects), settings, packs, Part::kAll);
  }
}

}  // namespace armcmc::bench
