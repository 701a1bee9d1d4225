#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/plant/effect.hpp"
#include "armcmc/plant/effect_scales.hpp"
#include "armcmc/plant/plant.hpp"

namespace armcmc::ladder {

/// A parameter that is an angular frequency: radians per unit of a signal, a state or time.
struct Frequency {
  std::size_t parameter;  ///< Index among the fitted parameters, which hold its logarithm.
  std::string along;      ///< Signal or state; empty: time.
};

/// A plant extended by an effect.
struct Candidate {
  const EffectEntry* entry = nullptr;  ///< Catalogue entry.
  EffectBinding binding;
  std::shared_ptr<const Plant> plant;
  std::size_t first_parameter = 0;  ///< Index of the effect's first parameter in the plant.

  [[nodiscard]] const EffectForm& form() const { return entry->forms[binding.form]; }
  /// Index of the first parameter of the effect among the fitted ones; each active mode may have its own copy.
  [[nodiscard]] std::size_t first_fitted() const;
  /// The frequencies among the parameters of the effect: positive parameters with the unit "1/s", or the inverse of the
  /// unit of a quantity that it needs.
  [[nodiscard]] std::vector<Frequency> Frequencies() const;
};

/// Every way in which an effect of `entries` can be added to the plant. Those beyond the limits of a plant are skipped,
/// with a note.
/// @param entries  Must outlive the candidates.
[[nodiscard]] std::vector<Candidate> Candidates(const PlantDescription& plant, const std::vector<EffectEntry>& entries,
                                                const DataScales& scales, std::vector<std::string>* notes);

/// Whether both are the same formula of one effect on the same quantities.
[[nodiscard]] bool SamePlace(const Candidate& a, const Candidate& b);

/// The same effect in the same place of another plant; empty if there is no room for it.
[[nodiscard]] std::optional<Candidate> SameOn(const PlantDescription& plant, const Candidate& effect,
                                              const DataScales& scales);

}  // namespace armcmc::ladder
