#pragma once

#include <cstdint>
#include <string>

#include "armcmc/data_pack.hpp"

namespace armcmc::bench {

/// A press on a soft object, for benchmarks that know the law: f = (K + B v) x^p, all samples in contact.
struct Press {
  double stiffness = 4.0, damping = 2.3, exponent = 1.7;  ///< K, B, p.
  double depth = 0.25, stroke = 0.2;                      ///< m: x = depth + stroke sin(2 pi f t).
  double frequency = 2.7;                                 ///< Hz
  double noise = 5e-3;                                    ///< N, Gaussian.
};

/// The built-in plant whose law that is.
[[nodiscard]] const std::string& PressedPlant();

/// Pack number `index` of a press, 1 kHz. Equal arguments give equal packs on every machine.
[[nodiscard]] DataPack MakePress(const Press& press, int index, int samples, std::uint64_t seed);

}  // namespace armcmc::bench
