#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/ladder/climb.hpp"
#include "armcmc/support/effect_library.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::test {

inline double Sign(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }

/// Effects that an axis may lack, of several families.
inline const std::vector<std::string> kSome{"coulomb_friction", "presliding_friction", "drag",    "cubic_stiffness",
                                            "output_drift",     "asymmetric_friction", "cogging", "sensor_lag"};

/// Climbs with a part of the catalogue, which takes a second where all of it takes ten.
/// @param kin  Whether effects know which ones act like them.
inline ladder::Ladder ClimbWith(const std::vector<std::string>& effects, const ladder::Dataset& data,
                                PlantDescription plant = AxisPlant(), bool kin = true) {
  ladder::ClimbRequest request;
  request.plant = std::make_shared<const Plant>(std::move(plant));
  for (EffectEntry& entry : support::ReadEffectLibrary())
    if (std::find(effects.begin(), effects.end(), entry.name) != effects.end())
      request.entries.push_back(std::move(entry));
  for (EffectEntry& entry : request.entries)
    if (!kin) entry.kin.clear();
  request.data = data;
  return ladder::Climb(request);
}

inline std::vector<std::string> NamesOf(const ladder::Rung& rung) {
  std::vector<std::string> names;
  for (const std::size_t i : rung.named) names.push_back(rung.contenders[i].candidate.entry->name);
  return names;
}

/// An axis that turns: angle, its rates, torque. 5 kg m^2, 9 N m s, over 5 rad.
inline ladder::Dataset RotaryData(const std::function<double(double angle)>& hidden) {
  constexpr double kPerMetre = 30.0;
  ladder::Dataset data = AxisData([&](const AxisSample& s) { return hidden(kPerMetre * s.q); });
  auto series = std::make_shared<identify::Series>(*data.series);
  for (std::size_t s = 0; s < 3; ++s)
    for (double& value : series->signals[s]) value *= kPerMetre;
  data.series = std::move(series);
  return data;
}

inline PlantDescription RotaryPlant() {
  PlantDescription plant = AxisPlant();
  const char* const units[] = {"rad", "rad/s", "rad/s^2", "N m"};
  for (std::size_t s = 0; s < plant.signals.size(); ++s) plant.signals[s].unit = units[s];
  plant.signals[3].role = "torque";
  for (ParameterDescription& p : plant.parameters) p.unit = p.unit == "kg" ? "kg m^2" : p.unit == "N" ? "N m" : "N m s";
  return plant;
}

}  // namespace armcmc::test

/// The tests that climb are in namespaces within this one, so that these names need no prefix there.
namespace armcmc::ladder::climbs {

using test::AxisSample;
using test::ClimbWith;
using test::kSome;
using test::NamesOf;
using test::RotaryData;
using test::RotaryPlant;
using test::Sign;

}  // namespace armcmc::ladder::climbs
