#pragma once

#include <span>
#include <string>
#include <string_view>

#include "armcmc/data_pack.hpp"
#include "armcmc/model.hpp"
#include "armcmc/models/compiled_plant.hpp"

namespace armcmc {

/// Every plant that is compiled in. The index into this list identifies its model inside the estimator.
[[nodiscard]] std::span<const ModelInfo* const> CompiledModels() noexcept ARMCMC_NONBLOCKING;

/// The name of the first of them: what programs show in examples, and use by default.
[[nodiscard]] std::string DefaultModel();

/// Every name that BuiltinSettings() takes, separated by ", ".
[[nodiscard]] std::string ModelNames();

/// Index of the model with that name, -1 if there is none.
[[nodiscard]] int FindModel(std::string_view name) noexcept;

/// The model whose packs have that number, null if there is none.
[[nodiscard]] const ModelInfo* ModelOf(PlantNumber number) noexcept ARMCMC_NONBLOCKING;

/// The effect with that name in the catalogue of a compiled plant, null if there is none.
[[nodiscard]] const EffectInfo* FindEffect(const ModelInfo& model, std::string_view name) noexcept;

}  // namespace armcmc
