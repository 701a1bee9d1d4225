#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/log_export/log_scan.hpp"
#include "armcmc/log_export/mcap_writer.hpp"
#include "sink.hpp"

namespace armcmc::log_export {

/// The topics of one MCAP file. Channels whose messages look alike share a schema: those of one type, unless plants of
/// several kinds are in the log.
class McapTopics {
 public:
  /// @param first_utime  us, of the first event of the log. @pre the writer outlives this object and its topics.
  McapTopics(McapWriter* writer, std::int64_t first_utime) : writer_(writer), first_utime_(first_utime) {}

  /// @pre channel.type is not null; plant outlives the topic.
  [[nodiscard]] std::unique_ptr<Sink> New(const ChannelScan& channel, const PlantScan& plant);

 private:
  struct Schema {
    std::string type, text;
    std::uint16_t id = 0;
  };

  McapWriter* writer_;
  std::int64_t first_utime_;
  std::vector<Schema> schemas_;
};

}  // namespace armcmc::log_export
