#pragma once

// The plants that the benchmark hides effects in.
#include "plants/hunt_crossley/cases.hpp"
#include "plants/soft_actuator/cases.hpp"
