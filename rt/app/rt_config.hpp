#pragma once

#include <vector>

#include "armcmc/rt/injection.hpp"
#include "armcmc/rt/settings.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "gap_log.hpp"

namespace armcmc::app {

/// Reads [timing], [rt] and [lcm] of an estimator configuration. Absent keys keep the defaults of RtSettings;
/// absent deadline_ms is the period, absent adjust_budget_ms four fifths of the smaller of period and deadline.
/// @throws support::ConfigError naming file, line, key and range.
[[nodiscard]] rt::RtSettings ReadRtSettings(support::StrictTable& root);

/// Reads [inject] plan: faults that the process is to make itself, for tests only. Absent: none.
/// @throws support::ConfigError naming file, line, key and what is allowed.
[[nodiscard]] std::vector<rt::InjectionItem> ReadInjections(support::StrictTable& root);

/// Reads [gap_log]: where the data around a suspected gap go.
/// @throws support::ConfigError naming file, line, key and range.
[[nodiscard]] GapLogSettings ReadGapLogSettings(support::StrictTable& root);

}  // namespace armcmc::app
