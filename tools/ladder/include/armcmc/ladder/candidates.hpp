#pragma once

#include <memory>
#include <string>
#include <vector>

#include "armcmc/plant/effect.hpp"
#include "armcmc/plant/effect_scales.hpp"
#include "armcmc/plant/plant.hpp"

namespace armcmc::ladder {

/// A parameter that is a number of radians per unit of something.
struct Frequency {
  std::size_t parameter;  ///< Among those that are fitted; its logarithm is.
  std::string along;      ///< Signal or state; empty: time.
};

/// A plant with one more effect.
struct Candidate {
  const EffectEntry* entry = nullptr;  ///< Of the entries that were asked for.
  EffectBinding binding;
  std::shared_ptr<const Plant> plant;
  std::size_t first_parameter = 0;  ///< Of the effect, among the plant's.

  [[nodiscard]] const EffectForm& form() const { return entry->forms[binding.form]; }
  /// The same among those that are fitted, of which each active mode may have its own.
  [[nodiscard]] std::size_t first_fitted() const;
  /// Those of the effect: positive ones with the unit "1/s", or one over that of something it needs.
  [[nodiscard]] std::vector<Frequency> Frequencies() const;
};

/// Every way in which one more effect of `entries` fits the plant; what does not fit a plant's limits is left out and
/// noted.
/// @param entries  Outlive the candidates.
[[nodiscard]] std::vector<Candidate> Candidates(const PlantDescription& plant, const std::vector<EffectEntry>& entries,
                                                const DataScales& scales, std::vector<std::string>* notes);

}  // namespace armcmc::ladder
