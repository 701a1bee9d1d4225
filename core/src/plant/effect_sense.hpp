#pragma once

#include "armcmc/plant/description.hpp"

namespace armcmc {

/// The sign with which a force against the motion stands in the laws of a plant: 1 where the output is the force that
/// moves it (F = m a + c v), -1 where it is the force that the plant passes on (F = p A - m a - c v).
///
/// A mass, a damper and a spring resist alike, so any of them tells: the first of the accelerations, velocities and
/// positions in which every law that reads it rises, or every law falls. Parameters have the sign of their
/// bounds, else of their means, and signals may have either. 1 where nothing tells.
///
/// @pre Plant(plant) passes. May allocate.
[[nodiscard]] int SenseOfResistance(const PlantDescription& plant);

}  // namespace armcmc
