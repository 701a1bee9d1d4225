#pragma once

#include <optional>

#include "armcmc/gap/workflow.hpp"
#include "armcmc/ladder/diagnosis.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::ladder {

/// What the ladder found, and the recording that it read.
struct SecondSearch {
  support::Recording recording;
  Diagnosis diagnosis;
};

/// Where the search of a compiled plant leaves a gap without a name: the same samples judged by the ladder, with the
/// plant's description and the effects that serve every plant. That search asks for an exact law beside one or two
/// effects of its own catalogue; the ladder names what is there beside a law that is off, and knows other effects.
/// Effects keep the names that the compiled plant has for them.
/// @param request  What the search was asked. The ladder keeps the end of `request.data` apart, as the search does.
/// @return empty where the ladder begins with no name, with one for few events or with several, where it explains all
///         rows but those kept apart, or where it is not asked: another recording is to be judged with it, the model
///         has effects already, only one is looked for, the run is to stop before the end, or the plant's file does not
///         read the columns of the data.
[[nodiscard]] std::optional<SecondSearch> SearchAgain(const gap::WorkflowRequest& request);

}  // namespace armcmc::ladder
