#include "armcmc/gap_bench/scenario_text.hpp"

#include <sstream>

namespace armcmc::gap_bench {
namespace {

/// Name of the table whose header a line is; empty for any other line.
std::string TableOf(const std::string& line) {
  if (line.empty() || line.front() != '[') return "";
  const std::size_t first = line.find_first_not_of('['), last = line.find(']');
  return last == std::string::npos || first == std::string::npos ? "" : line.substr(first, last - first);
}

template <typename Drop>
std::string Without(std::string_view toml, const Drop& drop) {
  std::istringstream lines{std::string(toml)};
  std::string kept;
  bool dropping = false;
  for (std::string line; std::getline(lines, line);) {
    const std::string table = TableOf(line);
    if (!table.empty()) dropping = drop(table);
    if (!dropping) kept += line + '\n';
  }
  return kept;
}

}  // namespace

std::string WithTable(std::string_view toml, std::string_view name, std::string_view body) {
  std::string text = Without(toml, [&](const std::string& table) { return table == name; });
  text += "\n[" + std::string(name) + "]\n" + std::string(body);
  if (text.back() != '\n') text += '\n';
  return text;
}

std::string WithoutTables(std::string_view toml, std::string_view prefix) {
  return Without(toml, [&](const std::string& table) { return table.starts_with(prefix); });
}

}  // namespace armcmc::gap_bench
