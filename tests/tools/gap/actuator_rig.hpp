#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/equation.hpp"
#include "armcmc/gap/recording.hpp"

namespace armcmc::gap::test {

/// What a recording of the plant hides: the values of all its parameters, or else a gap ratio that decides them.
struct HiddenInPlant {
  std::string name;
  double gap_ratio = 1.0;
  std::vector<double> values;
};

/// The first seconds of a scenario of the plant, with effects hidden; `noisy` false: without any noise.
[[nodiscard]] Recording RecordPlant(const std::string& scenario, const std::vector<HiddenInPlant>& hidden,
                                    unsigned long long seed, double seconds, bool noisy = true);

}  // namespace armcmc::gap::test
