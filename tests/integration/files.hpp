#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace armcmc::test {

/// All that is in a file.
inline std::string Text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Columns of a CSV file by name, as text: an empty field says that nothing was known.
using Table = std::map<std::string, std::vector<std::string>>;

inline Table ReadTable(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::string> names;
  Table table;
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> fields;
    std::istringstream cells(line + ",");
    for (std::string cell; std::getline(cells, cell, ',');) fields.push_back(cell);
    if (names.empty()) {
      names = fields;
    } else {
      for (std::size_t i = 0; i < names.size(); ++i) table[names[i]].push_back(fields.at(i));
    }
  }
  return table;
}

}  // namespace armcmc::test
