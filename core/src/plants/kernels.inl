// The loops of the plants that are compiled in, one line a plant; included by simd/kernels.inl, once per instruction
// set.

#include "plants/hunt_crossley/kernels.inl"
#include "plants/soft_actuator/kernels.inl"
