#pragma once

#include <optional>

#include "armcmc/gap/workflow.hpp"
#include "armcmc/ladder/diagnosis.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::ladder {

/// Result of the ladder, and the recording it was applied to.
struct SecondSearch {
  support::Recording recording;
  Diagnosis diagnosis;
};

/// Applies the ladder to a compiled plant whose own search left the gap unnamed: the same samples, with the plant's
/// file and the effects that fit any plant. The plant's own search assumes an exact law with one or two effects of its
/// own catalogue; the ladder allows for an inexact law and knows other effects. Effects keep the names that the
/// compiled plant gives them.
/// @param request  Request of the first search. The ladder holds out the end of `request.data`, as that search does.
/// @return empty if the first rung of the ladder names nothing, several effects, or one that acts in too few events; if
///   it explains all rows except the held-out ones; or if the ladder does not apply: with an earlier or held-out
///   recording, a model that already has effects, a search for single effects only, a run that stops before the last
///   step, or a plant file that does not read the columns of the data.
[[nodiscard]] std::optional<SecondSearch> SearchAgain(const gap::WorkflowRequest& request);

}  // namespace armcmc::ladder
