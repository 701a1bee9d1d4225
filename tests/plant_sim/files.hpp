#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace armcmc::plant_sim {

/// A file as it is.
[[nodiscard]] inline std::string Text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The cells of a line of a CSV file.
[[nodiscard]] inline std::vector<std::string> Fields(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream cells(line);
  for (std::string cell; std::getline(cells, cell, ',');) fields.push_back(cell);
  return fields;
}

/// A CSV file of numbers under one line of names.
struct CsvTable {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;
};
[[nodiscard]] inline CsvTable ReadTable(const std::filesystem::path& path) {
  std::ifstream file(path);
  CsvTable table;
  std::string line;
  std::getline(file, line);
  table.names = Fields(line);
  while (std::getline(file, line)) {
    std::vector<double>& row = table.rows.emplace_back();
    for (const std::string& cell : Fields(line)) row.push_back(std::stod(cell));
  }
  return table;
}

}  // namespace armcmc::plant_sim
