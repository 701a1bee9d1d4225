#include "armcmc/plant_sim/described_pack_sender.hpp"

#include <cstddef>

namespace armcmc::plant_sim {

DescribedPackSender::DescribedPackSender(const std::string& prefix, MessageSink* bus, MessageSink* log)
    : channel_(prefix + "PLANT_PACK_V2"),
      bus_(bus),
      log_(log),
      bytes_(static_cast<std::size_t>(data_pack_v2_t{}.getEncodedSize())) {
  // The fingerprint is computed on first use, behind a guard: not between two packs.
  static_cast<void>(data_pack_v2_t::getHash());
}

void DescribedPackSender::Send(const data_pack_v2_t& pack) noexcept {
  const int size = pack.encode(bytes_.data(), 0, static_cast<int>(bytes_.size()));
  if (size < 0) {
    ++errors_;
    return;
  }
  if (!bus_->Send(channel_.c_str(), bytes_.data(), size, pack.pack_utime)) ++errors_;
  if (log_ != nullptr) static_cast<void>(log_->Send(channel_.c_str(), bytes_.data(), size, pack.pack_utime));
}

}  // namespace armcmc::plant_sim
