#pragma once

#include "armcmc/gap/result.hpp"
#include "armcmc/ladder/climb.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/plant/description.hpp"

namespace armcmc::ladder {

/// The motion that would decide a tie, for any plant whose inputs move by themselves.
///
/// Motions of a small library are written for every input that the recording moved: within its range, up to four times
/// as fast, and such that the output goes at most twice as far. For each, and for each ordered pair of the tied
/// effects, the first is simulated as it was fitted and the other refitted to that; what stays is the evidence
///
///   D = min_theta |y_i - y_j(theta)|^2 / (2 f s^2)   nats,
///
/// s the error that the best of them leaves in the recording, noise or law, and f how many neighbouring errors go
/// together. The motion wins that decides most pairs, D / (D + 10) each, times how much of what the plant lacks the
/// other cannot take over, weighted by the probabilities of both; a quicker one must bring a tenth more.
///
/// @param data   The recording: all its rows tell how long and how fast.
/// @param rung   A tie.
/// @param plant  As a simulation knows it, without any of the tied effects.
/// @return words, nats, course; `scenario_text` for the plant's simulation, where a motion brings enough. Words alone
///   where a law reads what depends on the motion.
[[nodiscard]] gap::Experiment SeparatingMotion(const Dataset& data, const Rung& rung, const PlantDescription& plant);

}  // namespace armcmc::ladder
