#pragma once

#include <string>
#include <vector>

#include "armcmc/plant/description.hpp"
#include "armcmc/support/recording.hpp"
#include "recording_file.hpp"
#include "recording_rows.hpp"

namespace armcmc::support {

/// Rows at equal intervals: splits them into runs where time jumps, and interpolates where it is uneven.
/// Fills dt, t, runs, held_out and the signals that there are; notes what was done.
void Resample(const RecordingRows& rows, Recording* recording);

/// Filters what the file asks for and makes the derivatives that are missing; compares those that are given with what
/// they would be.
/// @param name  Of the recording file, for messages.
/// @throws ConfigError where a signal and its derivative contradict each other by a factor: a unit is wrong.
void Derive(const RecordingFile& file, const PlantDescription& plant, const std::string& name, Recording* recording);

}  // namespace armcmc::support
