#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "armcmc/data_pack.hpp"
#include "armcmc/data_pack_t.hpp"
#include "armcmc/data_pack_v2_t.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/pack_format.hpp"

namespace armcmc::rt {

/// Why a message on the pack channel is not a usable pack.
enum class RejectCause : std::uint8_t {
  kNone = 0,
  kFingerprint,     ///< Another type, or another version of ours.
  kLength,          ///< Truncated, or with trailing bytes.
  kOtherPlant,      ///< Pack of another plant.
  kSampleCount,     ///< n_samples outside [1, kMaxPackSamples].
  kInputCount,      ///< n_inputs is not that of the model.
  kSampleInterval,  ///< dt outside (0, kMaxSampleInterval] or not finite.
  kNotFinite,       ///< NaN or infinity in a value that is used.
  kOutOfRange,      ///< A value beyond kMaxMagnitude, a pack number outside [1, 2^62], a negative plant time.
  kAllZero,         ///< Two samples or more and every value exactly zero: a dead sensor, no measurement.
  kOverlap,         ///< n_samples is not a multiple of PackFormat::overlap.
};
/// Number of values, kNone included.
inline constexpr std::size_t kNumRejectCauses = 11;

/// The three groups in which estimator_status_t counts them.
enum class RejectGroup : std::uint8_t { kSize = 0, kType = 1, kValue = 2 };

/// Name of a cause for events and reports, "n_samples out of range".
[[nodiscard]] std::string_view ToString(RejectCause cause) noexcept ARMCMC_NONBLOCKING;
/// Group in which a cause is counted. @pre cause != kNone.
[[nodiscard]] RejectGroup GroupOf(RejectCause cause) noexcept ARMCMC_NONBLOCKING;

/// Decodes and checks packs from the bus: data_pack_t or data_pack_v2_t, depending on the format. Every value is
/// checked before it is used; a pack with any defect is rejected as a whole.
class PackCodec {
 public:
  static constexpr double kMaxSampleInterval = 10.0;  ///< s
  static constexpr double kMaxMagnitude = 1e9;        ///< Above any force, angle, position or pressure of a plant.

  /// @param format  What the model expects.
  explicit PackCodec(const PackFormat& format) noexcept;

  /// Decodes and checks one message; the pack stays inside until the next call.
  /// @param payload  Starts with the 8-byte fingerprint.
  /// @return kNone when CopyTo() may be used.
  /// @rt No heap, no lock, no throw. O(n_samples x n_inputs) after a decode of fixed size.
  [[nodiscard]] RejectCause Decode(std::span<const std::uint8_t> payload) noexcept ARMCMC_NONBLOCKING;

  /// Whether the last message had the type and the length of a pack, even if its contents were rejected, for example as
  /// a pack of another plant; number and run may then be read.
  [[nodiscard]] bool decoded() const noexcept { return decoded_; }
  /// Header of the last message. @pre decoded(). Values are unchecked unless Decode() returned kNone.
  [[nodiscard]] std::int64_t seq() const noexcept { return described() ? described_.seq : message_.seq; }
  [[nodiscard]] std::int64_t run_id() const noexcept { return described() ? described_.run_id : message_.run_id; }
  [[nodiscard]] std::int64_t t_last_ns() const noexcept {
    return described() ? described_.t_last_ns : message_.t_last_ns;
  }
  [[nodiscard]] double t_last_s() const noexcept { return described() ? described_.t_last_s : message_.t_last_s; }
  [[nodiscard]] double dt() const noexcept { return described() ? described_.dt : message_.dt; }
  [[nodiscard]] int num_samples() const noexcept { return described() ? described_.n_samples : message_.n_samples; }
  /// Copies header, used rows and used columns; the rest of *pack stays as it was.
  /// @pre the last Decode() returned kNone. @rt No heap, no lock, no throw. O(n_samples x n_inputs).
  void CopyTo(DataPack* pack) const noexcept ARMCMC_NONBLOCKING;

 private:
  [[nodiscard]] bool described() const noexcept { return format_.plant == PlantNumber::kDescribed; }
  [[nodiscard]] bool DecodeMessage(std::span<const std::uint8_t> payload) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] bool IsOfThePlant() const noexcept ARMCMC_NONBLOCKING;

  PackFormat format_;
  data_pack_t message_{};
  data_pack_v2_t described_{};
  std::array<std::uint8_t, sizeof(data_pack_v2_t::plant)> name_{};  ///< As packs of the plant carry it.
  std::int64_t fingerprint_;                                        ///< Fingerprint of the message type.
  std::size_t encoded_size_;
  bool decoded_ = false;
};

}  // namespace armcmc::rt
