#pragma once

#include <string>
#include <string_view>

namespace armcmc::gap_bench {

/// A scenario file with the table `name` replaced, or added where there is none.
/// @param name  "noise.f"
/// @param body  Lines of the new table, without its header.
[[nodiscard]] std::string WithTable(std::string_view toml, std::string_view name, std::string_view body);

/// A scenario file without the tables whose name starts with `prefix`.
[[nodiscard]] std::string WithoutTables(std::string_view toml, std::string_view prefix);

}  // namespace armcmc::gap_bench
