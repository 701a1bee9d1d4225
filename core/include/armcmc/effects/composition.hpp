#pragma once

#include <array>
#include <memory>
#include <string>

#include "armcmc/data_pack.hpp"
#include "armcmc/effects/effect_pack.hpp"
#include "armcmc/effects/effect_rows.hpp"
#include "armcmc/last_pack.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/settings.hpp"

namespace armcmc {

/// A base model with the effects of the settings: parameters and reported quantities of both, and the memory that the
/// effects carry from pack to pack.
///
/// The parameters are those of the base, then the amplitudes in the order of the settings, called NAME_PARAMETER. What
/// the effects do to a pack of a compiled plant is up to its EffectRows.
class Composition {
 public:
  /// @pre settings.Validate() passes.
  explicit Composition(const EstimatorSettings& settings);
  Composition(const Composition&) = delete;  // info_ points into names_
  Composition& operator=(const Composition&) = delete;

  /// No effect: the model predicts as it is.
  [[nodiscard]] bool empty() const noexcept { return rows_ == nullptr && plant_ == nullptr; }
  [[nodiscard]] const ModelInfo& info() const noexcept { return info_; }
  /// The settings with the amplitudes appended to the parameters: what a ParameterSpace is made from.
  [[nodiscard]] const EstimatorSettings& sampled() const noexcept { return sampled_; }
  /// Of a compiled plant; null where its law is used as it is.
  [[nodiscard]] const EffectRows* rows() const noexcept { return rows_.get(); }
  /// Every sample of a pack is explained by one law with its effects, whichever mode acts.
  [[nodiscard]] bool effects_on_output() const noexcept ARMCMC_NONBLOCKING;

  /// Room for one pack. Allocates.
  [[nodiscard]] EffectPack MakePack() const;

  /// Features of the pack, from the memory of the pack before; then remembers this one. A gap in the pack numbers,
  /// another run or another sample interval starts with an empty memory.
  /// @param out  By MakePack().
  /// @return false when a feature is not finite: nothing is remembered.
  /// @pre !empty(), pack.Validate() == kOk.
  /// @rt No heap, no lock, no throw. O(samples).
  [[nodiscard]] bool Prepare(const DataPack& pack, EffectPack* out) noexcept ARMCMC_NONBLOCKING;

  /// What the sampler scores of one mode. `effects` must outlive `data`.
  void Fill(const DataPack& pack, const EffectPack& effects, int mode,
            ModeData* data) const noexcept ARMCMC_NONBLOCKING;

  /// Mode that acts at sample n of a pack that was prepared; info().num_modes if none does.
  [[nodiscard]] int ModeOf(const DataPack& pack, const EffectPack& effects, int n) const noexcept ARMCMC_NONBLOCKING {
    return plant_ != nullptr ? effects.described.mode[static_cast<std::size_t>(n)] : info_.mode_of(pack, n);
  }

  /// The states at the end of the pack that was prepared last: where the next one starts. @rt O(states).
  void CarryStates(const std::array<double, kMaxStates>& end) noexcept ARMCMC_NONBLOCKING;

  /// Forgets the packs before.
  void Reset() noexcept ARMCMC_NONBLOCKING {
    described_[0].last = described_[1].last = {};
    if (rows_ != nullptr) rows_->Reset();
  }

 private:
  /// What one pack of a described plant leaves to the next. Two of them, so that a pack that fails changes nothing.
  struct DescribedMemory {
    LastPack last;
    expression::FeatureMemory features;
    StateMemory states;
  };

  [[nodiscard]] bool PrepareDescribed(const DataPack& pack, PlantPack* out) noexcept ARMCMC_NONBLOCKING;

  ModelInfo info_;
  EstimatorSettings sampled_;
  std::array<std::string, kMaxParams> names_;
  std::shared_ptr<const PlantProgram> plant_;  ///< Null: compiled in.
  std::array<DescribedMemory, 2> described_;
  int current_ = 0;
  std::unique_ptr<EffectRows> rows_;
};

}  // namespace armcmc
