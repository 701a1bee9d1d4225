#pragma once

namespace armcmc::plant_sim {

/// From now on SIGINT and SIGTERM only ask for an end.
void CatchSignals();
/// Whether one of them came.
[[nodiscard]] bool Interrupted();

}  // namespace armcmc::plant_sim
