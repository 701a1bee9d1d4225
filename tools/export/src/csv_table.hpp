#pragma once

#include <filesystem>
#include <memory>

#include "armcmc/log_export/log_scan.hpp"
#include "sink.hpp"

namespace armcmc::log_export {

/// A table of one channel.
/// @param long_histograms  Posteriors: a row a bin instead of a row a message.
/// @pre channel.type is not null; plant outlives the table.
/// @throws support::InputError when the file cannot be written.
[[nodiscard]] std::unique_ptr<Sink> NewCsvTable(const ChannelScan& channel, const PlantScan& plant,
                                                const std::filesystem::path& path, bool long_histograms);

}  // namespace armcmc::log_export
