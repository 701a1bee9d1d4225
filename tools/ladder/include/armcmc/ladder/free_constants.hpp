#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/ladder/candidates.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/trial.hpp"
#include "armcmc/plant/description.hpp"
#include "armcmc/plant/effect.hpp"

namespace armcmc::ladder {

/// A plant whose constants are fitted together with its parameters. What a plant file states as a number is known to a
/// few percent; an effect must be told from such an error, and may be hidden behind it.
struct FreeConstants {
  std::shared_ptr<const std::vector<EffectEntry>> entries;  ///< To which the candidates point.
  std::vector<ConstantDescription> constants;               ///< As the file states them.
  std::vector<Candidate> candidates;                        ///< One for each, in the order in which they were added.
  std::shared_ptr<const Plant> plant;
  Trial trial;  ///< The fit of `plant`.
};

/// Multiplies each constant of the file by 1 + NAME_off, a parameter with mean 0 and standard deviation 0.025, between
/// -0.05 and 0.05, and fits all of them together with the parameters of the plant.
/// @param own    The plant as its file states it. @param plant  The same, possibly with free starts.
/// @param known  Values of the plant's parameters from which to start; the best fit is kept.
/// @return empty if the plant has no constants, or no fit is valid.
[[nodiscard]] std::optional<FreeConstants> WithFreeConstants(const PlantDescription& own,
                                                             const std::shared_ptr<const Plant>& plant,
                                                             const Dataset& data, const DataScales& scales,
                                                             const std::vector<Eigen::VectorXd>& known);

/// "gap were 0.004 instead of 0.0039 and K were 31 instead of 30": the constants that the data place at least two
/// standard deviations from the file's value, or all of them if none does alone.
/// @param trial  Fit of the plant with free constants, possibly with effects added after them.
[[nodiscard]] std::string AsIf(const FreeConstants& free, const Trial& trial, const std::vector<std::uint8_t>& rows);

/// The plant with the same constants freed; those are left out that it has no place for.
[[nodiscard]] PlantDescription AddFreeConstants(PlantDescription plant, const FreeConstants& free,
                                                const DataScales& scales);

}  // namespace armcmc::ladder
