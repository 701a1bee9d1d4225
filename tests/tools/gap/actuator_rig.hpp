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
  std::string variant = {};  ///< Empty: drawn, or the first with these values.
};

/// The first seconds of a scenario of the plant, with effects hidden; `noisy` false: without any noise; `drawn` true:
/// what the scenario leaves to chance, such as parameters, is as this seed draws it; `law_error`: rms share by which
/// the plant's law differs from its formula.
[[nodiscard]] Recording RecordPlant(const std::string& scenario, const std::vector<HiddenInPlant>& hidden,
                                    unsigned long long seed, double seconds, bool noisy = true, bool drawn = false,
                                    double law_error = 0.0);

}  // namespace armcmc::gap::test
