#pragma once

#include <array>
#include <memory>

#include "armcmc/data_pack.hpp"
#include "armcmc/effects/composition.hpp"
#include "armcmc/gap_watch/gap_block.hpp"
#include "armcmc/gap_watch/gap_checks.hpp"
#include "armcmc/gap_watch/gap_starts.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/settings.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
}

/// Point estimates of all modes, and the noise to measure errors by.
struct GapReference {
  std::array<bool, kMaxModes> known{};
  std::array<std::array<double, kMaxParams>, kMaxModes> theta{};
  std::array<double, kMaxModes> noise_std{};
};

/// Errors and sensitivities of packs, for any model: the scoring kernel is called once for the reference and two points
/// beside it for each parameter, side by side in one tile. Of a plant with states, the starts are fitted to each pack,
/// and what they can explain is projected out of errors and sensitivities (GapStarts).
class GapLineariser {
 public:
  /// @param settings  Valid; of the estimator. @param judges_passive  See GapFamily.
  GapLineariser(const EstimatorSettings& settings, int model, const simd::Kernels& kernels, bool judges_passive);

  /// Parameters of all modes together: columns of GapRows.
  [[nodiscard]] int num_columns() const noexcept { return info().num_modes * info().num_parameters; }
  [[nodiscard]] const ModelInfo& info() const noexcept { return composition_.info(); }
  [[nodiscard]] const ParameterSettings& parameter(int column) const noexcept ARMCMC_NONBLOCKING;
  /// The parameters of `reference` moved by `shift`, kept inside their bounds.
  [[nodiscard]] GapReference Moved(const GapReference& reference,
                                   const GapShift& shift) const noexcept ARMCMC_NONBLOCKING;

  /// @param modes  Mode of every sample.
  /// @return false when a prediction is not finite. @rt No heap, no lock, no throw. O(samples).
  [[nodiscard]] bool Linearise(const DataPack& pack, const GapReference& at, GapRows* rows,
                               std::array<int, kMaxPackSamples>* modes) noexcept ARMCMC_NONBLOCKING;
  /// Forgets the packs before.
  void Reset() noexcept {
    composition_.Reset();
    if (starts_) starts_->Reset();
  }
  /// values <- what the starts of the states of the pack that was linearised last cannot explain of them.
  void RemoveStarts(std::array<double, kMaxPackSamples>* values) const noexcept ARMCMC_NONBLOCKING {
    if (starts_) starts_->directions().Remove(values);
  }
  /// States at the first sample of that pack. @pre The law has states.
  [[nodiscard]] const std::array<double, kMaxStates>& start() const noexcept ARMCMC_NONBLOCKING {
    return effects_.described.states.value;
  }

 private:
  void FillTheta(const std::array<double, kMaxParams>& theta) noexcept ARMCMC_NONBLOCKING;
  /// predict() of `theta_`. @return false where the states have no finite trajectory.
  [[nodiscard]] bool Predict(const DataPack& pack, double noise_std) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] bool FillMode(int mode, double noise_std, const std::array<int, kMaxPackSamples>& modes,
                              GapRows* rows) noexcept ARMCMC_NONBLOCKING;
  /// Errors of the samples at which no mode acts.
  void FillPassive(const DataPack& pack, double noise_std, const std::array<int, kMaxPackSamples>& modes,
                   GapRows* rows) const noexcept ARMCMC_NONBLOCKING;

  const EstimatorSettings& settings_;
  int model_;
  const simd::Kernels& kernels_;
  bool judges_passive_;
  Composition composition_;
  EffectPack effects_;
  ModeData data_;
  std::unique_ptr<GapStarts> starts_;  ///< Null: the law has no states.
  StateTile no_offset_{}, end_;
  ThetaTile theta_;
  PredictionTile prediction_;
};

}  // namespace armcmc
