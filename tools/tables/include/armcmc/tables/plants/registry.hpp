#pragma once

#include <string>

#include "armcmc/data_pack.hpp"
#include "armcmc/settings.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "plants/soft_actuator/model.hpp"

namespace armcmc::tables {

/// One of the two plants of the paper's experiments: the one place here that says which they are.
struct PaperPlant {
  const ModelInfo& model;
  const char* title;       ///< For people, as a heading.
  const char* experiment;  ///< The same with what it does.

  /// Key in tables.json, and what the names of its scenarios and of its recording begin with.
  [[nodiscard]] std::string key() const { return std::string(model.name); }
  [[nodiscard]] std::string key(const char* suffix) const { return key() + suffix; }
  [[nodiscard]] bool Is(PlantNumber plant) const { return plant == model.plant; }
  [[nodiscard]] bool Is(const EstimatorSettings& settings) const { return settings.model == model.name; }
};

inline constexpr PaperPlant kContact{HuntCrossley::kInfo, "Hunt-Crossley", "Hunt-Crossley contact"};
inline constexpr PaperPlant kActuator{SoftActuator::kInfo, "Soft actuator", "Soft bending actuator"};

}  // namespace armcmc::tables
