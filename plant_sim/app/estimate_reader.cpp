#include "estimate_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>
#include <type_traits>

namespace armcmc::plant_sim {
namespace {

constexpr std::size_t kNameBytes = std::extent_v<decltype(estimate_t::param_name), 1>;

/// Column of a parameter in the message, -1 when it is not there.
int FindColumn(const estimate_t& message, std::string_view name) {
  const int n = std::clamp(message.n_params, 0, static_cast<int>(estimate_t::MAX_PARAMS));
  for (int i = 0; i < n; ++i) {
    char text[kNameBytes];
    std::memcpy(text, message.param_name[i], kNameBytes);
    if (name == std::string_view(text, strnlen(text, kNameBytes))) return i;
  }
  return -1;
}

}  // namespace

ReceivedEstimate ReadEstimate(const PlantFamily& family, const estimate_t& message, double arrival_s) {
  ReceivedEstimate estimate;
  estimate.seq = message.seq;
  estimate.arrival_s = arrival_s;
  const int num_modes = std::clamp(message.n_modes, 0, family.num_modes());
  for (int m = 0; m < num_modes; ++m) estimate.known[static_cast<std::size_t>(m)] = message.known_by_mode[m] != 0;
  // The interval belongs to the mode that acts, or with one mode only to that one also while it rests.
  const int mode = message.mode < num_modes ? message.mode : (num_modes == 1 ? 0 : -1);
  if (message.known != 0 && mode >= 0 && estimate.known[static_cast<std::size_t>(mode)]) estimate.interval_mode = mode;
  for (std::size_t i = 0; i < family.truth_names.size(); ++i) {
    const int column = FindColumn(message, family.truth_names[i]);
    bool usable = column >= 0;
    for (int m = 0; usable && m < num_modes; ++m) {
      estimate.theta[static_cast<std::size_t>(m)][i] = message.ar_map_by_mode[m][column];
      usable = std::isfinite(message.ar_map_by_mode[m][column]);
    }
    if (!usable) {
      estimate.known.fill(false);
      estimate.interval_mode = -1;
      return estimate;
    }
    estimate.lo[i] = message.q025[column];
    estimate.hi[i] = message.q975[column];
  }
  return estimate;
}

}  // namespace armcmc::plant_sim
