#pragma once

#include <array>
#include <memory>

#include "armcmc/data_pack.hpp"
#include "armcmc/effects/effect_rows.hpp"
#include "armcmc/last_pack.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/settings.hpp"
#include "plants/hunt_crossley/contact_pack.hpp"
#include "plants/hunt_crossley/effects.hpp"

namespace armcmc {

/// Packs of the contact with effects. Mode 0 uses every sample of a pack: free motion says something on a bias, a drag
/// or a mass. Features of the depth (adhesion, relaxation) do not depend on the candidate: beside a contact offset they
/// count it from the mean of that offset's prior, frozen as shapes are.
class ContactRows final : public EffectRows {
 public:
  /// @param settings  Valid, with effects.
  explicit ContactRows(const EstimatorSettings& settings);

  [[nodiscard]] std::unique_ptr<CompiledPack> MakePack() const override;
  [[nodiscard]] bool additive_only() const noexcept override { return memory_[0].pack.additive_only(); }
  [[nodiscard]] bool Prepare(const DataPack& pack, CompiledPack* out) noexcept ARMCMC_NONBLOCKING override;
  void Fill(const DataPack& pack, const CompiledPack& rows, int mode,
            ModeData* data) const noexcept ARMCMC_NONBLOCKING override;
  void Reset() noexcept ARMCMC_NONBLOCKING override;

 private:
  struct Term {
    const EffectInfo* info = nullptr;
    EffectFeatureFn feature = nullptr;
    std::array<double, kMaxEffectShapes> shapes{};
    EffectGate gate = EffectGate::kAlways;
    double from_s = 0.0, until_s = 0.0;
    int parameter = 0;  ///< Row of its first amplitude among the parameters.
  };
  /// What one pack leaves to the next. Two of them, so that a pack that fails changes nothing.
  struct Memory {
    LastPack last;
    std::array<std::array<double, kEffectMemory>, kMaxEffects> filter{};
    ContactPack pack;
  };

  void Assign(ContactPack* pack) const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] int HistoryFor(double dt) const noexcept ARMCMC_NONBLOCKING;
  static void CopyRows(const ContactPack& from, int first, int count, ContactPack* to) noexcept ARMCMC_NONBLOCKING;
  void FillRow(const EffectInput& in, int row, Memory* memory) const noexcept ARMCMC_NONBLOCKING;
  /// What features are made from: x counts from the surface.
  [[nodiscard]] EffectInput FromSurface(EffectInput in) const noexcept ARMCMC_NONBLOCKING;

  int num_terms_ = 0;
  std::array<Term, kMaxEffects> terms_;
  int surface_ = -1;                                ///< Term that displaces it, -1: none.
  double surface_m_ = 0.0;                          ///< Mean of that term's prior.
  double longest_delay_ = 0.0, longest_lag_ = 0.0;  ///< Upper bounds of the priors, s.
  std::array<Memory, 2> memory_;
  int current_ = 0;
};

}  // namespace armcmc
