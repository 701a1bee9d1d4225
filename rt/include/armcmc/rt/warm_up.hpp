#pragma once

#include "armcmc/data_pack.hpp"
#include "armcmc/rt/pack_format.hpp"
#include "armcmc/rt/step_engine.hpp"

namespace armcmc::rt {

/// A plausible pack of a built-in plant: smooth motion, output of typical parameters, no noise. Of a described plant
/// one of smooth signals, which fit its format and not its law.
/// @param format  Of the plant's packs.
/// @param index   0, 1, 2, ...: consecutive packs of the same motion.
[[nodiscard]] DataPack SyntheticPack(const PackFormat& format, int index) noexcept ARMCMC_NONBLOCKING;

/// Runs a few synthetic packs through an engine and resets it, so that code, tables and memory have been touched
/// before the first release. Call it on the thread that adjusts.
/// @rt Not real-time: takes as long as it takes.
void WarmUp(StepEngine* engine) noexcept;

}  // namespace armcmc::rt
