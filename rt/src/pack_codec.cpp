#include "armcmc/rt/pack_codec.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "armcmc/types.hpp"

namespace armcmc::rt {

static_assert(std::extent_v<decltype(data_pack_t::y)> == kMaxPackSamples);
static_assert(std::extent_v<decltype(data_pack_t::u)> == kMaxPackSamples);
static_assert(std::extent_v<decltype(data_pack_t::u), 1> == data_pack_t::MAX_INPUTS);
static_assert(data_pack_t::MAX_SAMPLES == kMaxPackSamples && data_pack_t::MAX_INPUTS <= kMaxPackInputs);
static_assert(std::extent_v<decltype(data_pack_v2_t::y)> == kMaxPackSamples);
static_assert(std::extent_v<decltype(data_pack_v2_t::u)> == kMaxPackSamples);
static_assert(std::extent_v<decltype(data_pack_v2_t::u), 1> == kMaxPackInputs);
static_assert(data_pack_v2_t::MAX_SAMPLES == kMaxPackSamples && data_pack_v2_t::MAX_INPUTS == kMaxPackInputs);

namespace {

std::int64_t ReadFingerprint(std::span<const std::uint8_t> payload) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value = (value << 8U) | payload[i];
  return static_cast<std::int64_t>(value);
}

/// Checks the numbers of a pack of the right type and plant.
template <typename Message>
RejectCause Check(const Message& m, const PackFormat& format) noexcept ARMCMC_NONBLOCKING {
  const int num_inputs = format.num_inputs;
  if (m.n_samples < 1 || m.n_samples > kMaxPackSamples) return RejectCause::kSampleCount;
  if (m.n_samples % format.overlap != 0) return RejectCause::kOverlap;
  if (m.n_inputs != num_inputs) return RejectCause::kInputCount;
  if (!(m.dt > 0.0 && m.dt <= PackCodec::kMaxSampleInterval)) return RejectCause::kSampleInterval;
  if (!std::isfinite(m.t_last_s)) return RejectCause::kNotFinite;
  const std::int64_t seq = m.seq;
  if (seq < 1 || seq > (std::int64_t{1} << 62) || m.t_last_s < 0.0) return RejectCause::kOutOfRange;

  bool finite = true, in_range = true, all_zero = m.n_samples > 1;
  const auto look = [&](double value) {
    finite = finite && std::isfinite(value);
    in_range = in_range && std::fabs(value) <= PackCodec::kMaxMagnitude;
    all_zero = all_zero && value == 0.0;
  };
  for (int n = 0; n < m.n_samples; ++n) {
    look(m.y[n]);
    for (int i = 0; i < num_inputs; ++i) look(m.u[n][i]);
  }
  if (!finite) return RejectCause::kNotFinite;
  if (!in_range) return RejectCause::kOutOfRange;
  return all_zero ? RejectCause::kAllZero : RejectCause::kNone;
}

template <typename Message>
void Copy(const Message& m, DataPack* pack) noexcept ARMCMC_NONBLOCKING {
  pack->seq = m.seq;
  pack->run_id = m.run_id;
  pack->t_last_ns = m.t_last_ns;
  pack->t_last_s = m.t_last_s;
  pack->dt = m.dt;
  pack->num_samples = m.n_samples;
  pack->num_inputs = m.n_inputs;
  for (std::size_t n = 0; n < static_cast<std::size_t>(m.n_samples); ++n) {
    pack->y[n] = m.y[n];
    for (std::size_t i = 0; i < static_cast<std::size_t>(m.n_inputs); ++i) pack->u[n][i] = m.u[n][i];
  }
}

}  // namespace

std::string_view ToString(RejectCause cause) noexcept {
  switch (cause) {
    case RejectCause::kNone: return "none";
    case RejectCause::kFingerprint: return "fingerprint of another message type";
    case RejectCause::kLength: return "wrong message length";
    case RejectCause::kOtherPlant: return "pack of another plant";
    case RejectCause::kSampleCount: return "n_samples out of range";
    case RejectCause::kInputCount: return "n_inputs is not that of the model";
    case RejectCause::kSampleInterval: return "dt out of range";
    case RejectCause::kNotFinite: return "NaN or infinite value";
    case RejectCause::kOutOfRange: return "value out of range";
    case RejectCause::kAllZero: return "every value is zero";
    case RejectCause::kOverlap: return "n_samples is not a multiple of timing.overlap";
  }
  return "unknown";
}

RejectGroup GroupOf(RejectCause cause) noexcept {
  switch (cause) {
    case RejectCause::kFingerprint:
    case RejectCause::kOtherPlant: return RejectGroup::kType;
    case RejectCause::kNotFinite:
    case RejectCause::kAllZero:
    case RejectCause::kOutOfRange: return RejectGroup::kValue;
    default: return RejectGroup::kSize;
  }
}

// getHash() here, since its first call takes a lock.
PackCodec::PackCodec(const PackFormat& format) noexcept
    : format_(format),
      fingerprint_(format.plant == PlantNumber::kDescribed ? data_pack_v2_t::getHash() : data_pack_t::getHash()),
      encoded_size_(static_cast<std::size_t>(format.plant == PlantNumber::kDescribed ? described_.getEncodedSize()
                                                                                     : message_.getEncodedSize())) {
  std::transform(format.name.begin(),
                 format.name.begin() + static_cast<std::ptrdiff_t>(std::min(format.name.size(), name_.size())),
                 name_.begin(), [](char c) { return static_cast<std::uint8_t>(c); });
}

ARMCMC_TRUST_NONBLOCKING_BEGIN  // decode() looks up the fingerprint in a static variable that the constructor filled
    bool
    PackCodec::DecodeMessage(std::span<const std::uint8_t> payload) noexcept ARMCMC_NONBLOCKING {
  const int size = static_cast<int>(payload.size());
  return described() ? described_.decode(payload.data(), 0, size) >= 0 : message_.decode(payload.data(), 0, size) >= 0;
}
ARMCMC_TRUST_NONBLOCKING_END

bool PackCodec::IsOfThePlant() const noexcept ARMCMC_NONBLOCKING {
  if (!described()) return message_.plant_kind == static_cast<std::int32_t>(format_.plant);
  return described_.fingerprint == static_cast<std::int64_t>(format_.fingerprint) &&
         std::equal(name_.begin(), name_.end(), described_.plant);
}

RejectCause PackCodec::Decode(std::span<const std::uint8_t> payload) noexcept {
  decoded_ = false;
  if (payload.size() < 8) return RejectCause::kLength;
  if (ReadFingerprint(payload) != fingerprint_) return RejectCause::kFingerprint;
  if (payload.size() != encoded_size_) return RejectCause::kLength;
  if (!DecodeMessage(payload)) return RejectCause::kLength;
  decoded_ = true;
  if (!IsOfThePlant()) return RejectCause::kOtherPlant;
  return described() ? Check(described_, format_) : Check(message_, format_);
}

void PackCodec::CopyTo(DataPack* pack) const noexcept ARMCMC_NONBLOCKING {
  pack->plant = format_.plant;
  pack->fingerprint = format_.fingerprint;
  if (described()) {
    Copy(described_, pack);
  } else {
    Copy(message_, pack);
  }
}

}  // namespace armcmc::rt
