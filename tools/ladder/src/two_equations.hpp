#pragma once

#include "armcmc/ladder/diagnosis.hpp"

namespace armcmc::ladder {

/// Diagnose() for a plant that `predicts` its output in addition to the target of its modes.
[[nodiscard]] Diagnosis DiagnoseBoth(const DiagnosisRequest& request);

}  // namespace armcmc::ladder
