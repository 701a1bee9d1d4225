#pragma once

#include <memory>
#include <string_view>

#include "armcmc/data_pack.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// One pack as the scoring kernels of a compiled plant with effects read it: what it holds is the plant's own affair.
struct CompiledPack {
  CompiledPack() = default;
  CompiledPack(const CompiledPack&) = delete;
  CompiledPack& operator=(const CompiledPack&) = delete;
  virtual ~CompiledPack() = default;
};

/// Packs of a compiled plant with its effects, and the memory that the effects carry from pack to pack.
class EffectRows {
 public:
  EffectRows() = default;
  EffectRows(const EffectRows&) = delete;
  EffectRows& operator=(const EffectRows&) = delete;
  virtual ~EffectRows() = default;

  /// Room for one pack. Allocates.
  [[nodiscard]] virtual std::unique_ptr<CompiledPack> MakePack() const = 0;
  /// Unit of what is regressed with effects; empty: that of the law alone.
  [[nodiscard]] virtual std::string_view target_unit() const noexcept { return {}; }

  /// All that the effects do is to add amplitude x feature to the law.
  [[nodiscard]] virtual bool additive_only() const noexcept { return false; }

  /// Fills `out`, which MakePack() made, from a pack and the memory of those before; then remembers this one.
  /// @return false when a number is not finite: nothing is remembered.
  /// @pre pack.Validate() == kOk. @rt No heap, no lock, no throw. O(samples).
  [[nodiscard]] virtual bool Prepare(const DataPack& pack, CompiledPack* out) noexcept ARMCMC_NONBLOCKING = 0;
  /// What the sampler scores of one mode. `rows` must outlive `data`. @rt As Prepare().
  virtual void Fill(const DataPack& pack, const CompiledPack& rows, int mode,
                    ModeData* data) const noexcept ARMCMC_NONBLOCKING = 0;
  /// Forgets the packs before.
  virtual void Reset() noexcept ARMCMC_NONBLOCKING = 0;
};

}  // namespace armcmc
