#pragma once

#include <armcmc/support/strict_toml.hpp>

#include "armcmc/plant_sim/described_plant.hpp"
#include "armcmc/plant_sim/described_simulation.hpp"

namespace armcmc::plant_sim {

/// Reads a plant file, for simulation: reports are left out.
/// @throws support::ConfigError, also for a plant that uses effects of a catalogue, which the simulated plant does not
/// have.
[[nodiscard]] DescribedPlant ReadDescribedPlant(support::StrictTable root);

/// Reads a scenario of a described plant:
///
///   schema = 1
///   rate_hz = 1000
///   duration_s = 10
///   seed = 1
///   pack_stride = 10   samples from pack to pack; left out: as many as a pack has
///   [truth]     M = 95.0, or a list of one value a mode; left out: the mean of the prior
///   [inputs]    q = { kind = "multisine" | "sine" | "chirp" | "steps", amplitude, offset, frequency_hz, bandwidth_hz }
///               or { expression = "0.1*sin(t)" } or { state = "x" }
///   [start]     first values of states; of the output, where `start` reads it
///   [noise]     law = "gaussian" | "student_t" | "laplace" | "mixture" | "none", std
///   [[hidden]]  slot = "output" | "input:NAME" | "rate:STATE", value = "expression"
///
/// @throws support::ConfigError.
[[nodiscard]] DescribedScenario ReadDescribedScenario(support::StrictTable root);

/// The error at the place of its key in the scenario (keys "scenario.*") or the plant file.
/// @param scenario  Null: there is no file.
[[nodiscard]] support::ConfigError Placed(const DescribedError& error, const support::StrictTable& plant,
                                          const support::StrictTable* scenario);

}  // namespace armcmc::plant_sim
