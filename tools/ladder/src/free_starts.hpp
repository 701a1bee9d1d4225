#pragma once

#include <memory>

#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/trial.hpp"
#include "armcmc/plant/description.hpp"

namespace armcmc::ladder {

/// The start of a state becomes known up to an error about 0, the parameter NAME_start.
/// @param sd  Of that error, unit of the state.
void FreeStart(StateDescription* state, double sd, PlantDescription* plant);

/// The plant with free starts of the states that begin with the measured output or with a mere number, where this is
/// felt in more than half of a recording of one run; in more than a tenth where the start is a number, or several
/// states begin with the output, of which one at most is measured. The noise of one sample is in such a start, an
/// integrator keeps it to the end, and there it looks like an offset or a drift of the sensor. What a state was before
/// the recording began to move it, as a cart that comes in at a speed, does the same.
/// @param trial  The plant as it came, fitted to `data`. @param noise  Standard deviation of the output's noise.
/// @return null: there are none.
[[nodiscard]] std::shared_ptr<const Plant> WithFreeStarts(const Trial& trial, const Dataset& data, double noise);

/// The plant with starts as `own` has them: they are those of one recording, and no part of a model.
[[nodiscard]] PlantDescription WithOwnStarts(PlantDescription plant, const PlantDescription& own);

}  // namespace armcmc::ladder
