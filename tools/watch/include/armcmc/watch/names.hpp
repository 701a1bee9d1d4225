#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "armcmc/plant_truth_t.hpp"

namespace armcmc::watch {

/// The estimator never listens to it, so the names of its channels leave it out.
inline constexpr char kTruthChannel[] = "PLANT_TRUTH";

/// The modes of a plant, as the model that estimates it calls them; "mode 7" for what it does not have.
[[nodiscard]] std::string ModeName(int plant_kind, int mode);
[[nodiscard]] std::string DecisionName(int decision);
/// What a flag of estimator_status_t says, one entry for each that is set.
[[nodiscard]] std::vector<std::string> DegradedWords(int flags);
[[nodiscard]] std::vector<std::string> FaultWords(int flags);

/// ASCII of a zero padded field; control characters become '?', so that no message can steer a terminal.
[[nodiscard]] std::string FieldText(const std::uint8_t* field, int size);

/// "N/m^p per s"; "per s" of what has no unit.
[[nodiscard]] std::string PerSecond(const std::string& unit);

/// The true value of a parameter where the plant tells it, else NaN.
[[nodiscard]] double TrueValue(const plant_truth_t& truth, const estimate_t& estimate, int parameter) noexcept;

[[nodiscard]] std::string Joined(const std::vector<std::string>& words);

}  // namespace armcmc::watch
