#pragma once

#include "armcmc/gap/result.hpp"
#include "armcmc/ladder/climb.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/plant/description.hpp"

namespace armcmc::ladder {

/// The motion that best separates tied effects, for any plant whose inputs can be moved freely.
///
/// The motions of a small library are written for every input that the recording moved: within its range, up to four
/// times as fast, and with at most twice the range of the output. For each motion and each ordered pair (i, j) of tied
/// effects, effect i is simulated as fitted and model j is refitted to that simulation. The remaining misfit is the
/// expected evidence
///
///   D = min_theta |y_i - y_j(theta)|^2 / (2 f s^2)   nats,
///
/// where s is the error that the best model leaves in the recording (noise or model error), and f the number of
/// neighbouring samples that share an error. The score of a motion is the sum over the pairs of D / (D + 10), times the
/// share of effect i that model j cannot absorb, weighted with the probabilities of both effects. A faster motion is
/// preferred only if its score is 10 % higher.
///
/// @param data   The recording; all its rows determine range and speed.
/// @param rung   A tie.
/// @param plant  The plant without any of the tied effects.
/// @return words, nats, course, and `scenario_text` for the simulator if a motion gives enough evidence. Words alone if
///   a law reads a signal that results from the motion.
[[nodiscard]] gap::Experiment SeparatingMotion(const Dataset& data, const Rung& rung, const PlantDescription& plant);

}  // namespace armcmc::ladder
