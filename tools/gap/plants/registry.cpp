// The plants that the workflow has equations of: the one place here that lists them.

#include <array>
#include <stdexcept>
#include <utility>

#include "armcmc/gap/equation.hpp"
#include "armcmc/models/registry.hpp"
#include "gap/plants/hunt_crossley/contact_equation.hpp"
#include "gap/plants/soft_actuator/actuator_equation.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "plants/soft_actuator/model.hpp"

namespace armcmc::gap {
namespace {

using Equations = std::vector<std::unique_ptr<Equation>>;

Equations OfContact(const std::string& model) {
  Equations equations;
  equations.push_back(MakeContactEquation(BuiltinSettings(model).model));
  return equations;
}

Equations OfActuator(const std::string& model) {
  Equations equations;
  equations.push_back(MakeFlowEquation(model));
  equations.push_back(MakeBendEquation(model));
  return equations;
}

struct PlantEquations {
  const ModelInfo& model;
  Equations (*make)(const std::string& model);
};

constexpr std::array<PlantEquations, 2> kPlants{{{HuntCrossley::kInfo, OfContact}, {SoftActuator::kInfo, OfActuator}}};

/// The compiled plant behind a built-in name; empty: there is none.
std::string PlantOf(const std::string& model) {
  try {
    return BuiltinSettings(model).model;
  } catch (const std::invalid_argument&) {
    return {};
  }
}

}  // namespace

std::vector<std::unique_ptr<Equation>> MakeEquations(const std::string& model) {
  const std::string name = PlantOf(model);
  for (const PlantEquations& plant : kPlants)
    if (plant.model.name == name) return plant.make(model);
  throw std::invalid_argument("the workflow knows no equation of '" + model + "'; known are " + ModelNames());
}

}  // namespace armcmc::gap
