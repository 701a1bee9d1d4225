#pragma once

#include <memory>
#include <string_view>

#include "armcmc/data_pack.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// One pack as the scoring kernels of a compiled plant with effects read it. Its content is defined by the plant; this
/// base class only gives it an owner.
struct CompiledPack {
  CompiledPack() = default;
  CompiledPack(const CompiledPack&) = delete;
  CompiledPack& operator=(const CompiledPack&) = delete;
  virtual ~CompiledPack() = default;
};

/// Turns packs of a compiled plant into what the kernels score, with the effects added to the law, and keeps the memory
/// that effects carry from pack to pack (delays, hysteresis). Not shared between threads: adjust owns it, and packs
/// have to come in the order of their time.
class EffectRows {
 public:
  EffectRows() = default;
  EffectRows(const EffectRows&) = delete;
  EffectRows& operator=(const EffectRows&) = delete;
  virtual ~EffectRows() = default;

  /// Allocates the memory of one pack, for Prepare(). At set-up.
  [[nodiscard]] virtual std::unique_ptr<CompiledPack> MakePack() const = 0;
  /// Unit of what is regressed with effects; empty: that of the law alone.
  [[nodiscard]] virtual std::string_view target_unit() const noexcept { return {}; }

  /// Whether every effect only adds amplitude x feature to the law, so that the law stays linear in the amplitudes.
  [[nodiscard]] virtual bool additive_only() const noexcept { return false; }

  /// Fills `out` from a pack and the memory of earlier ones; then remembers this pack.
  /// @param pack  Checked: pack.Validate() == kOk.
  /// @param out   Made by MakePack() of the same object.
  /// @return false if a value is not finite; then nothing is remembered.
  /// @rt No heap, no lock, no throw. O(samples).
  [[nodiscard]] virtual bool Prepare(const DataPack& pack, CompiledPack* out) noexcept ARMCMC_NONBLOCKING = 0;
  /// Fills the data of one mode, as the sampler scores them.
  /// @param pack  As given to Prepare().
  /// @param rows  As filled by Prepare(); must outlive `data`.
  /// @param mode  Index of a mode.
  /// @param[out] data  Samples of the pack in that mode.
  /// @rt No heap, no lock, no throw. O(samples).
  virtual void Fill(const DataPack& pack, const CompiledPack& rows, int mode,
                    ModeData* data) const noexcept ARMCMC_NONBLOCKING = 0;
  /// Clears the memory of earlier packs, as at the start of a run. @rt No heap, no lock, no throw.
  virtual void Reset() noexcept ARMCMC_NONBLOCKING = 0;
};

}  // namespace armcmc
