#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include "armcmc/baselines/regression_form.hpp"
#include "armcmc/data_pack.hpp"
#include "armcmc/effects/effect.hpp"
#include "armcmc/effects/effect_rows.hpp"
#include "armcmc/gap_watch/gap_checks.hpp"
#include "armcmc/gap_watch/output_watch.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/output_predictor.hpp"
#include "armcmc/settings.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

struct ModelInfo;

/// A column of a pack, and of a recording.
struct SignalInfo {
  std::string_view name;
  std::string_view unit;
  std::string_view derivative_of;  ///< Signal that it can be made from where a recording lacks it; empty: none.
};

/// A constant that is known, not estimated.
struct ConstantInfo {
  std::string_view name;
  std::string_view unit;
  double value;            ///< Unless the settings say another.
  double least, most;      ///< Allowed values, both included.
  std::string_view above;  ///< Constant before this one that it has to be larger than; empty: none.
};

/// Other settings of a compiled plant, under a name of their own.
struct ModelVariant {
  std::string_view name;
  void (*apply)(EstimatorSettings* settings);  ///< Changes the defaults of the plant.
};

/// A rate as measured and as the law has it.
struct RatePair {
  double measured, predicted;
};

/// What the engine asks of a plant that is compiled in: facts, and functions that its folder core/plants/NAME/ defines.
/// It is named nowhere else, except in the lists of core/src/plants/.
///
/// The folder also has a struct in model.hpp with
///   static constexpr ModelInfo kInfo;
///   template <class S> static typename S::V Predict(const typename S::V* theta, const ModeData&, int n) noexcept;
///   template <class S> static typename S::V AddTo(typename S::V base, const typename S::V* theta, const ModeData&,
///                                                 int n) noexcept;
///   static double LargestLog2(const ModeData&, int n) noexcept;
/// and, in kernels.inl, its loops with effects (see simd/kernels.inl).
struct CompiledPlant {
  std::array<SignalInfo, kMaxPackInputs> inputs;  ///< Columns of DataPack::u.
  SignalInfo output;
  std::string_view output_word;  ///< What it is, in words.
  /// What the law explains is the output; else the output is simulated from the parameters, over time.
  bool law_is_output;
  std::string_view no_contact_as;  ///< Why effects cannot act in contact or in free motion only; empty: they can.
  std::span<const ConstantInfo> constants;  ///< kMaxConstants at most.
  std::string_view rate_unit;   ///< Of what EstimatorSettings::regress_rate has regressed; empty: it has none.
  std::string_view offline_as;  ///< Why some of `effects` do not run online; {} in it stands for the formula.
  std::span<const EffectInfo* const> effects;  ///< Its catalogue.
  std::span<const ModelVariant> variants;

  /// The samples of one mode without effects: features and target.
  void (*prepare)(const DataPack& pack, const PlantConstants& constants, int mode,
                  ModeData* data) noexcept ARMCMC_NONBLOCKING;
  /// The law at one of those samples, for one candidate.
  double (*predict)(const double* theta, const ModeData& data, int n) noexcept;
  /// Of a plant that has a rate_unit, else null: that rate at sample n of a pack where a mode acts.
  RatePair (*rate)(const double* theta, const DataPack& pack, int n, const PlantConstants& constants) noexcept;
  /// Sample n at time t of a typical run, for warming up. @rt No heap, no lock, no throw.
  void (*typical_sample)(double t, std::size_t n, DataPack* pack) noexcept ARMCMC_NONBLOCKING;
  /// Null where the settings leave the law as it is. Allocates.
  std::unique_ptr<EffectRows> (*make_rows)(const EstimatorSettings& settings);
  /// @param info  With the effects; outlives the predictor. @param rows  What make_rows() made, or null. Allocates.
  std::unique_ptr<OutputPredictor> (*make_predictor)(const ModelInfo& info, const PlantConstants& constants,
                                                     const EffectRows* rows);
  /// Of a second equation, which is watched but not estimated; null: there is none. Allocates.
  /// @param rate  Of false alarms. @param predictor  What make_predictor() made; outlives the watch.
  std::unique_ptr<OutputWatch> (*make_watch)(const EstimatorSettings& settings, double rate,
                                             const OutputPredictor& predictor);
  const GapFamily& (*gap_family)() noexcept;
  const RegressionForm* regression;  ///< Null: the law is linear in its parameters.

  [[nodiscard]] constexpr int num_equations() const noexcept { return make_watch != nullptr ? 2 : 1; }
};

}  // namespace armcmc
