#pragma once

#include <cstdint>
#include <cstring>

#include "armcmc/estimate_t.hpp"

namespace armcmc::log_export {

/// An estimate of a contact, whose values depend on its number.
inline estimate_t ContactEstimate(std::int64_t seq) {
  estimate_t e{};
  e.seq = seq;
  e.run_id = 77;
  e.plant_kind = 1;
  e.n_params = 3;
  e.n_modes = 1;
  const char* const names[] = {"K", "B", "p"};
  const char* const units[] = {"N/m^p", "N s/m^(p+1)", "-"};
  for (int i = 0; i < 3; ++i) {
    std::memcpy(e.param_name[i], names[i], std::strlen(names[i]));
    std::memcpy(e.param_unit[i], units[i], std::strlen(units[i]));
    e.ar_map[i] = 0.1 * static_cast<double>(seq) + i;
  }
  return e;
}

}  // namespace armcmc::log_export
