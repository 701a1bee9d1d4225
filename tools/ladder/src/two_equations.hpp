#pragma once

#include "armcmc/ladder/diagnosis.hpp"

namespace armcmc::ladder {

/// Diagnose() for a plant that `predicts` its output beside what its modes explain.
[[nodiscard]] Diagnosis DiagnoseBoth(const DiagnosisRequest& request);

}  // namespace armcmc::ladder
