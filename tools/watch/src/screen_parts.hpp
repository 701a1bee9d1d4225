#pragma once

#include <string>
#include <vector>

#include "armcmc/watch/screen.hpp"

namespace armcmc::watch {

// The blocks of the screen, from the top. Each appends its lines; the first two end with an empty one.
// They may be called only when there is a status.

void AddParameters(const WatchState& state, const View& view, std::vector<TextLine>* lines);
void AddStages(const WatchState& state, const View& view, std::vector<TextLine>* lines);
void AddSampler(const WatchState& state, const View& view, std::vector<TextLine>* lines);
/// Whether the parameters persisted, drifted or changed; a line for each mode that is known.
void AddChangeProbabilities(const WatchState& state, const View& view, std::vector<TextLine>* lines);
void AddData(const WatchState& state, std::vector<TextLine>* lines);

/// Where the watch for gaps sees the most, in words.
[[nodiscard]] std::string GapPlace(const estimator_status_t& status);

}  // namespace armcmc::watch
