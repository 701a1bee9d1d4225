// Whatever comes from the bus: wire format, pack, sequence, and the checks of core.
#include <cstdint>
#include <string>

#include "armcmc/data_pack.hpp"
#include "armcmc/rt/lcm_receiver.hpp"
#include "armcmc/rt/pack_codec.hpp"
#include "armcmc/rt/sequence_tracker.hpp"
#include "plants/hunt_crossley/model.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armcmc;
  static const std::string channel = "PLANT_PACK";
  static rt::PackCodec codec({HuntCrossley::kInfo.plant, 2});
  static rt::SequenceTracker tracker;
  std::span<const std::uint8_t> payload;
  if (rt::ParseDatagram({data, size}, channel, &payload) != rt::DatagramKind::kOurs) return 0;
  if (codec.Decode(payload) != rt::RejectCause::kNone) {
    if (codec.decoded()) (void)tracker.OnUnusable(codec.seq(), codec.run_id());
    return 0;
  }
  (void)tracker.OnPack(codec.seq(), codec.run_id());
  static DataPack pack;
  codec.CopyTo(&pack);
  if (pack.Validate() != Status::kOk) __builtin_trap();  // what the codec lets pass, core takes
  return 0;
}
