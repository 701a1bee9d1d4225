#include "armcmc/watch/watch_state.hpp"

#include <algorithm>
#include <limits>

#include "armcmc/rt/lcm_url.hpp"
#include "armcmc/watch/names.hpp"

namespace armcmc::watch {
namespace {

constexpr double kHoldFaults_s = 3.0;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// An LCM message begins with the fingerprint of its type, big endian.
std::int64_t Fingerprint(const std::uint8_t* bytes) noexcept {
  std::uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value = value << 8 | bytes[i];
  return static_cast<std::int64_t>(value);
}

template <typename Message>
bool Decode(const void* bytes, int size, double now_s, WatchState* state) {
  if (size < 8 || Fingerprint(static_cast<const std::uint8_t*>(bytes)) != Message::getHash()) {
    ++state->bus.foreign;
    return false;
  }
  Message message{};
  if (message.decode(bytes, 0, size) < 0) {
    ++state->bus.undecodable;
    return false;
  }
  state->Take(message, now_s);
  return true;
}

}  // namespace

void WatchState::Take(const estimator_status_t& message, double now_s) {
  if (status) {
    const double gap = now_s - status_s;
    period_s = period_s == 0.0 ? gap : period_s + 0.05 * (gap - period_s);
  }
  status_s = now_s;
  if (message.fault_flags != 0) {
    held_faults = now_s - faults_s < kHoldFaults_s ? held_faults | message.fault_flags : message.fault_flags;
    faults_s = now_s;
  } else if (now_s - faults_s > kHoldFaults_s) {
    held_faults = 0;
  }
  if (HasStep(message)) {
    ++steps;
    end_to_end_ms.Add(1e-6 * static_cast<double>(message.end_to_end_ns));
  }
  status = message;
}

void WatchState::Take(const estimate_t& message, double) {
  const int n = std::clamp<int>(message.n_params, 0, estimate_t::MAX_PARAMS);
  for (int i = 0; i < n; ++i) means[static_cast<std::size_t>(i)].Add(message.known != 0 ? message.ar_ap[i] : kNaN);
  zeta.Add(message.decision == estimate_t::DECISION_HOLD ? kNaN : message.zeta);
  estimate = message;
}

void WatchState::Take(const posterior_t& message, double) { posterior = message; }

void WatchState::Take(const change_t& message, double) {
  const int mode = std::clamp<int>(message.mode, 0, change_t::MAX_MODES - 1);
  drifted.Add(message.known[mode] != 0 ? message.p_drifted[mode] : kNaN);
  change = message;
}

void WatchState::Take(const plant_truth_t& message, double) { truth = message; }

bool WatchState::TakeBytes(const std::string& name, const void* bytes, int size, double now_s) {
  if (name == rt::kStatusChannel) {
    return Decode<estimator_status_t>(bytes, size, now_s, this) && HasStep(*status);
  }
  if (name == rt::kEstimateChannel) {
    Decode<estimate_t>(bytes, size, now_s, this);
  } else if (name == rt::kPosteriorChannel) {
    Decode<posterior_t>(bytes, size, now_s, this);
  } else if (name == rt::kChangeChannel) {
    Decode<change_t>(bytes, size, now_s, this);
  } else if (name == kTruthChannel) {
    Decode<plant_truth_t>(bytes, size, now_s, this);
  }
  return false;
}

}  // namespace armcmc::watch
