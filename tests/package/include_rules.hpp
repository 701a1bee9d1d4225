#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace armcmc::test {

/// Who may include whom: the directions in which the parts of the tree depend on each other.
///
///   core      -> Eigen, the standard library; no clock, no thread, no I/O, no LCM
///   rt        -> core, lcm_types, liblcm, POSIX
///   plant_sim -> lcm_types, liblcm, Eigen, POSIX; never core
///   tools     -> core, rt, lcm_types, liblcm, POSIX
///   app       -> tools/support and the libraries of programs, beside what its part may
///   tests     -> everything; nothing -> tests
///
/// @param file  Path relative to the root of the tree: it decides which part the text belongs to.
/// @return one line for each include that is not allowed, "FILE:LINE: ...". Empty for files of no part.
[[nodiscard]] std::vector<std::string> ForbiddenIncludes(const std::filesystem::path& file, std::string_view text);

}  // namespace armcmc::test
