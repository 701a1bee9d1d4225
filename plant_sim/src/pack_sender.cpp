#include "armcmc/plant_sim/pack_sender.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <utility>

namespace armcmc::plant_sim {
namespace {

constexpr int kTypeBytes = 8;  // the fingerprint in front of every message

}  // namespace

PackSender::PackSender(const std::string& prefix, FaultPlan faults, MessageSink* sink)
    : pack_channel_(prefix + "PLANT_PACK"),
      truth_channel_(prefix + "PLANT_TRUTH"),
      faults_(std::move(faults)),
      sink_(sink),
      pack_bytes_(static_cast<std::size_t>(scratch_.getEncodedSize())),
      held_bytes_(pack_bytes_.size()),
      truth_bytes_(static_cast<std::size_t>(plant_truth_t{}.getEncodedSize())) {
  // The fingerprints are computed on first use, behind a guard: not in the publishing thread.
  static_cast<void>(data_pack_t::getHash());
  static_cast<void>(plant_truth_t::getHash());
}

void PackSender::SendPack(const std::uint8_t* bytes, int size, std::int64_t utime) noexcept {
  if (!sink_->Send(pack_channel_.c_str(), bytes, size, utime)) ++errors_;
}

void PackSender::Send(const data_pack_t& pack, const plant_truth_t& truth) noexcept {
  const auto has = [&](FaultKind kind) { return faults_.Has(kind, pack.seq); };
  const int truth_size = truth.encode(truth_bytes_.data(), 0, static_cast<int>(truth_bytes_.size()));

  if (has(FaultKind::kForeign)) SendPack(truth_bytes_.data(), truth_size, pack.utime);
  if (has(FaultKind::kGarbage)) {
    static constexpr std::array<std::uint8_t, 32> kGarbage = {0xde, 0xad, 0xbe, 0xef, 0xde, 0xad, 0xbe, 0xef};
    SendPack(kGarbage.data(), static_cast<int>(kGarbage.size()), pack.utime);
  }

  const data_pack_t* message = &pack;
  const double ahead_ms = faults_.ClockMs(pack.seq);
  if (has(FaultKind::kNan) || has(FaultKind::kSize) || has(FaultKind::kZero) || has(FaultKind::kHuge) ||
      ahead_ms > 0.0) {
    scratch_ = pack;
    scratch_.t_last_ns += static_cast<std::int64_t>(ahead_ms * 1e6);
    if (has(FaultKind::kHuge)) scratch_.y[pack.n_samples / 2] = 1e300;
    if (has(FaultKind::kZero)) {
      std::fill(std::begin(scratch_.y), std::end(scratch_.y), 0.0);
      for (auto& row : scratch_.u) std::fill(std::begin(row), std::end(row), 0.0);
    }
    if (has(FaultKind::kNan)) scratch_.y[pack.n_samples / 2] = std::numeric_limits<double>::quiet_NaN();
    if (has(FaultKind::kSize)) scratch_.n_samples = data_pack_t::MAX_SAMPLES + 1;
    message = &scratch_;
  }
  const int size = message->encode(pack_bytes_.data(), 0, static_cast<int>(pack_bytes_.size()));
  if (has(FaultKind::kCorrupt)) {
    for (auto byte = pack_bytes_.begin() + kTypeBytes; byte != pack_bytes_.end(); ++byte) *byte ^= 0xa5;
  }
  const bool hold = has(FaultKind::kReorder);
  if (!hold && !has(FaultKind::kDrop)) {
    SendPack(pack_bytes_.data(), size, pack.utime);
    if (has(FaultKind::kDuplicate)) SendPack(pack_bytes_.data(), size, pack.utime);
  }
  Flush();
  if (hold) {
    std::swap(pack_bytes_, held_bytes_);
    held_size_ = size;
    held_utime_ = pack.utime;
  }
  if (!sink_->Send(truth_channel_.c_str(), truth_bytes_.data(), truth_size, truth.utime)) ++errors_;
}

void PackSender::Flush() noexcept {
  if (held_size_ > 0) SendPack(held_bytes_.data(), held_size_, held_utime_);
  held_size_ = 0;
}

}  // namespace armcmc::plant_sim
