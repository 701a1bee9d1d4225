#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "armcmc/log_export/log_scan.hpp"

namespace armcmc::log_export {

/// One column of a table: a number of the message, or of the sample that the row stands for.
struct Column {
  std::string header;             ///< "ar_map.K [N m^-p]"
  std::vector<std::string> path;  ///< Names in the header: "ar_map", "K".
  std::string unit;               ///< "N m^-p"; empty: none.
  bool bin = false;               ///< The last name is the number of a bin, which counts from 0 without gaps.
  const MessageField* field = nullptr;
  std::size_t index = 0;          ///< Of the number, or of the text.
  std::size_t sample_stride = 0;  ///< Numbers from one sample to the next; 0: the same on every row.
  bool text = false;
};

/// The columns of a channel, after the time. Array elements are called by the names of parameters, modes and inputs;
/// entries that the plant does not use are left out.
/// @pre channel.type is not null.
[[nodiscard]] std::vector<Column> ColumnsOf(const ChannelScan& channel, const PlantScan& plant);

/// Name of parameter i of the plant: as the estimates say, else as the plant kind has it.
[[nodiscard]] std::string ParameterName(const PlantScan& plant, std::size_t i);
/// Its unit, without "/".
[[nodiscard]] std::string ParameterUnit(const PlantScan& plant, std::size_t i);

}  // namespace armcmc::log_export
