#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "armcmc/data_pack_v2_t.hpp"
#include "armcmc/plant_sim/message_sink.hpp"

namespace armcmc::plant_sim {

/// Encodes packs of a described plant into a preallocated buffer and hands the bytes on.
class DescribedPackSender {
 public:
  /// @param prefix goes before the channel's name, PLANT_PACK_V2. @param bus, log must outlive the sender; log may be
  /// null.
  DescribedPackSender(const std::string& prefix, MessageSink* bus, MessageSink* log);

  /// To the bus, then to the log. @rt No heap, no lock of its own, no throw; the cost of the sinks comes on top.
  void Send(const data_pack_v2_t& pack) noexcept;

  [[nodiscard]] std::int64_t errors() const noexcept { return errors_; }  ///< Packs that the bus did not take.

 private:
  std::string channel_;
  MessageSink* bus_;
  MessageSink* log_;
  std::vector<std::uint8_t> bytes_;
  std::int64_t errors_ = 0;
};

}  // namespace armcmc::plant_sim
