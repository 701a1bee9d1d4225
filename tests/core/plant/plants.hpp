#pragma once

#include <memory>

#include "armcmc/plant/program.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::test {

/// The contact of the paper as a plant file says it.
inline PlantDescription DescribedContact() {
  PlantDescription plant;
  plant.name = "contact";
  plant.output = "f";
  plant.signals = {{"x", "m", "position", ""}, {"v", "m/s", "velocity", "x"}, {"f", "N", "force", ""}};
  plant.parameters = {{"K", "N/m^p", "normal", 2.5, 2.0, 0.0, 8.0},
                      {"B", "N s/m^(p+1)", "normal", 2.5, 2.0, 0.0, 8.0},
                      {"p", "1", "normal", 1.5, 0.35, 1.0, 2.5}};
  plant.modes = {{"contact", "x >= 0", "x^p * (K + B*v)", "", false}, {"free", "", "", "", true}};
  plant.noise.std = 0.1;
  return plant;
}

/// A mass with viscous friction and an offset: linear in its parameters.
inline PlantDescription DescribedAxis() {
  PlantDescription plant;
  plant.name = "axis";
  plant.output = "F";
  plant.law = "M*a + Fv*v + off";
  plant.signals = {{"v", "m/s", "velocity", ""}, {"a", "m/s^2", "acceleration", "v"}, {"F", "N", "force", ""}};
  plant.parameters = {{"M", "kg", "normal", 90.0, 30.0, 1.0, 500.0},
                      {"Fv", "N s/m", "normal", 200.0, 100.0, 0.0, 2000.0},
                      {"off", "N", "normal", 0.0, 10.0}};
  plant.noise.std = 1.0;
  return plant;
}

/// A mass on a spring, simulated: its position is measured.
inline PlantDescription SimulatedSpring() {
  PlantDescription plant;
  plant.name = "spring";
  plant.output = "y";
  plant.law = "pos";
  plant.signals = {{"u", "m/s^2", "drive", ""}, {"y", "m", "position", ""}};
  plant.parameters = {{"k", "1/s^2", "normal", 10.0, 5.0, 0.0, 100.0}};
  plant.states = {{"pos", "m", "position", "speed", "y", ""}, {"speed", "m/s", "velocity", "u - k*pos", "0", ""}};
  return plant;
}

/// A vessel that a valve fills (u > 0) and drains (u < 0) at rates that are measured; its level is what is shown.
inline PlantDescription DescribedVessel() {
  PlantDescription plant;
  plant.name = "vessel";
  plant.output = "y";
  plant.predicts = "level";
  plant.signals = {{"u", "1", "drive", ""}, {"r", "m/s", "", ""}, {"y", "m", "level", ""}};
  plant.parameters = {{"g", "m/s", "normal", 0.0, 5.0}};
  plant.parameters[0].per_mode = true;
  plant.modes = {
      {"fill", "u > 0", "g*u", "r", false}, {"drain", "u < 0", "g*u", "r", false}, {"shut", "", "", "", true}};
  plant.states = {{"level", "m", "level", "if(u != 0, g*u, 0)", "y", "", 1}};
  plant.noise.std = 0.05;
  return plant;
}

/// A vessel that is filled and leaks; its level is a state, and is measured.
inline PlantDescription LeakyVessel() {
  PlantDescription plant;
  plant.name = "leaky_vessel";
  plant.output = "y";
  plant.law = "level";
  plant.signals = {{"u", "V", "drive", ""}, {"y", "V", "level", ""}};
  plant.parameters = {{"a", "1/s", "normal", 1.0, 2.0, 0.0, 20.0}, {"b", "1/s", "normal", 1.0, 2.0, 0.0, 20.0}};
  plant.states = {{"level", "V", "level", "b*u - a*level", "y", "", 1}};
  plant.noise.std = 0.01;
  return plant;
}

inline std::shared_ptr<const PlantProgram> Program(PlantDescription plant) {
  return std::make_shared<const PlantProgram>(std::make_shared<const Plant>(std::move(plant)));
}

}  // namespace armcmc::test
