#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "armcmc/plant_sim/simulation.hpp"

namespace armcmc::plant_sim {

/// Writes a scenario's samples from 0 on: t, the measured inputs and output, then what is true of the regression
/// target and of the parameters of the acting mode. 17 digits, so that reading the file gives the same bits.
/// A passive mode shows the parameters of the first identified one.
class CsvWriter {
 public:
  /// @throws std::runtime_error when the file cannot be opened.
  CsvWriter(const Scenario& scenario, std::uint64_t seed, const std::string& path);

  /// Writes every sample up to and including this index.
  /// @throws std::runtime_error when the plant leaves the finite range or the disk is full.
  void WriteThrough(long long index);
  /// Flushes and closes. @throws std::runtime_error when the file could not be written completely.
  void Close();

 private:
  struct Closer {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };
  void WriteRow();

  const PlantFamily& family_;
  std::string path_;
  Simulation simulation_;
  std::unique_ptr<std::FILE, Closer> file_;
};

}  // namespace armcmc::plant_sim
