#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "armcmc/gap/result.hpp"

namespace armcmc::gap {

/// "none", "named", "ambiguous" or "unnamed".
[[nodiscard]] std::string_view Name(Verdict verdict) noexcept;

/// The result as the content of result.json, schema 1: everything but the curves of the figures.
///
/// Keys that are present for every verdict: schema, verdict, sentence, probability, effects, ambiguous_set,
/// separate_by, candidates, where, gap, parameters, budget, and the provenance. Numbers that are not finite are null;
/// text is valid UTF-8, so that dump() never throws.
[[nodiscard]] nlohmann::json ToJson(const Result& result);

}  // namespace armcmc::gap
