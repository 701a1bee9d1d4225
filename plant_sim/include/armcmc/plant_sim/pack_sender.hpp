#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/plant_sim/fault_plan.hpp"
#include "armcmc/plant_sim/message_sink.hpp"
#include "armcmc/plant_truth_t.hpp"

namespace armcmc::plant_sim {

/// Encodes packs into preallocated buffers, applies the requested faults, and passes the bytes on.
class PackSender {
 public:
  /// @param prefix goes before every channel name. @param sink must outlive the sender.
  PackSender(const std::string& prefix, FaultPlan faults, MessageSink* sink);

  /// Sends a pack and its truth. @rt No heap, no lock of its own, no throw; the sink's cost comes on top.
  void Send(const data_pack_t& pack, const plant_truth_t& truth) noexcept;
  /// Sends a pack that was held back to be reordered and had no successor.
  void Flush() noexcept;

  [[nodiscard]] std::int64_t errors() const noexcept { return errors_; }  ///< Messages the sink did not take.

 private:
  void SendPack(const std::uint8_t* bytes, int size, std::int64_t utime) noexcept;

  std::string pack_channel_, truth_channel_;
  FaultPlan faults_;
  MessageSink* sink_;
  data_pack_t scratch_{};
  std::vector<std::uint8_t> pack_bytes_, held_bytes_, truth_bytes_;
  int held_size_ = 0;  ///< 0: nothing is held back.
  std::int64_t held_utime_ = 0;
  std::int64_t errors_ = 0;
};

}  // namespace armcmc::plant_sim
