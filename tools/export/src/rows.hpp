#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "armcmc/log_export/columns.hpp"
#include "armcmc/log_export/log_scan.hpp"

namespace armcmc::log_export {

/// The rows that the messages of one channel make, in the order of the log.
class Rows {
 public:
  /// @pre channel.type is not null; plant and columns outlive this object.
  Rows(const ChannelScan& channel, const PlantScan& plant, const std::vector<Column>& columns);

  /// Rows are samples, with times of their own.
  [[nodiscard]] bool per_sample() const { return per_sample_; }

  /// Calls `row` with time and sample number of every row of a message. Packs may overlap: what they share comes once.
  /// @param t  s, since the first event of the log.
  void ForEach(std::span<const std::uint8_t> data, const MessageType& type, double t,
               const std::function<void(double t, std::size_t sample)>& row);

 private:
  const PlantScan& plant_;
  bool per_sample_ = false;
  int room_ = 0;  ///< Samples that a message has place for.
  std::int64_t last_run_ = 0, last_seq_ = 0;
  double last_t_ = 0.0;
};

}  // namespace armcmc::log_export
