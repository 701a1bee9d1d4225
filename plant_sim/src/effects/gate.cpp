#include "armcmc/plant_sim/effects/gate.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace armcmc::plant_sim {

Gate Gate::Parse(const std::string& text) {
  if (text == "always") return {};
  if (text == "contact") return {Kind::kContact};
  if (text == "free") return {Kind::kFree};
  const std::size_t colon = text.find(':');
  const std::string word = text.substr(0, colon);
  if (colon != std::string::npos && (word == "from" || word == "until")) {
    const std::string number = text.substr(colon + 1);
    char* end = nullptr;
    const double at_s = std::strtod(number.c_str(), &end);
    if (!number.empty() && *end == '\0' && std::isfinite(at_s) && at_s > 0.0)
      return {word == "from" ? Kind::kFrom : Kind::kUntil, at_s};
  }
  throw std::invalid_argument("\"" + text + "\": expected always, contact, free, from:S or until:S with S > 0 seconds");
}

std::string Gate::Text() const {
  char seconds[32];
  std::snprintf(seconds, sizeof(seconds), "%.17g", at_s);
  switch (kind) {
    case Kind::kAlways: return "always";
    case Kind::kContact: return "contact";
    case Kind::kFree: return "free";
    case Kind::kFrom: return std::string("from:") + seconds;
    case Kind::kUntil: return std::string("until:") + seconds;
  }
  return {};
}

bool Gate::Open(const PlantSample& truth) const noexcept {
  switch (kind) {
    case Kind::kAlways: return true;
    case Kind::kContact: return truth.mode == 0;
    case Kind::kFree: return truth.mode != 0;
    case Kind::kFrom: return truth.t_s >= at_s;
    case Kind::kUntil: return truth.t_s < at_s;
  }
  return true;
}

}  // namespace armcmc::plant_sim
