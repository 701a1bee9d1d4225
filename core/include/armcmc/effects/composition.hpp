#pragma once

#include <array>
#include <string>

#include "armcmc/data_pack.hpp"
#include "armcmc/effects/effect_pack.hpp"
#include "armcmc/effects/flow_plan.hpp"
#include "armcmc/effects/flow_rows.hpp"
#include "armcmc/effects/registry.hpp"
#include "armcmc/last_pack.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/settings.hpp"

namespace armcmc {

/// A base model with the effects of the settings: parameters and reported quantities of both, and the memory that the
/// effects carry from pack to pack.
///
/// The parameters are those of the base, then the amplitudes in the order of the settings, called NAME_PARAMETER.
///
/// Contact plant: with effects, mode 0 uses every sample of a pack: free motion says something on a bias, a drag or a
/// mass. Features of the depth (adhesion, relaxation) do not depend on the candidate: beside a contact offset they
/// count it from the mean of that offset's prior, frozen as shapes are. Soft actuator: with effects, or where the
/// settings ask for it, what is regressed is the pressure rate (see FlowLaw), whose noise is that of a sensor, so that
/// the noise of the settings is in Pa/s; each valve has its own amplitudes.
class Composition {
 public:
  /// @pre settings.Validate() passes.
  explicit Composition(const EstimatorSettings& settings);
  Composition(const Composition&) = delete;  // info_ points into names_
  Composition& operator=(const Composition&) = delete;

  /// The model predicts what it does by itself.
  [[nodiscard]] bool empty() const noexcept { return num_terms_ == 0 && flow_.empty && plant_ == nullptr; }
  [[nodiscard]] const ModelInfo& info() const noexcept { return info_; }
  /// The settings with the amplitudes appended to the parameters: what a ParameterSpace is made from.
  [[nodiscard]] const EstimatorSettings& sampled() const noexcept { return sampled_; }

  /// The pressure rate that the valve flow makes; empty where it is not what is regressed.
  [[nodiscard]] const FlowPlan& flow() const noexcept { return flow_; }

  /// Features of the pack, from the memory of the pack before; then remembers this one. A gap in the pack numbers,
  /// another run or another sample interval starts with an empty memory.
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
  void Reset() noexcept {
    memory_[0].last = memory_[1].last = {};
    described_[0].last = described_[1].last = {};
    flow_rows_.Reset();
  }

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

  /// What one pack of a described plant leaves to the next; two, as above.
  struct DescribedMemory {
    LastPack last;
    expression::FeatureMemory features;
    StateMemory states;
  };

  [[nodiscard]] bool PrepareDescribed(const DataPack& pack, PlantPack* out) noexcept ARMCMC_NONBLOCKING;
  void SetUpContact(const EstimatorSettings& settings);
  [[nodiscard]] bool PrepareContact(const DataPack& pack, ContactPack* out) noexcept ARMCMC_NONBLOCKING;
  void Assign(ContactPack* pack) const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] int HistoryFor(double dt) const noexcept ARMCMC_NONBLOCKING;
  static void CopyRows(const ContactPack& from, int first, int count, ContactPack* to) noexcept ARMCMC_NONBLOCKING;
  void FillRow(const EffectInput& in, int row, Memory* memory) const noexcept ARMCMC_NONBLOCKING;
  /// What features are made from: x counts from the surface.
  [[nodiscard]] EffectInput FromSurface(EffectInput in) const noexcept ARMCMC_NONBLOCKING;

  ModelInfo info_;
  EstimatorSettings sampled_;
  std::array<std::string, kMaxParams> names_;
  int num_terms_ = 0;
  std::shared_ptr<const PlantProgram> plant_;  ///< Null: built in.
  std::array<DescribedMemory, 2> described_;
  // Soft actuator.
  FlowPlan flow_;
  FlowRows flow_rows_;
  // Contact plant.
  std::array<Term, kMaxEffects> terms_;
  int surface_ = -1;                                ///< Term that displaces it, -1: none.
  double surface_m_ = 0.0;                          ///< Mean of that term's prior.
  double longest_delay_ = 0.0, longest_lag_ = 0.0;  ///< Upper bounds of the priors, s.
  std::array<Memory, 2> memory_;
  int current_ = 0;
};

}  // namespace armcmc
