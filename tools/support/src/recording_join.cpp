#include <algorithm>
#include <cmath>

#include "armcmc/support/program.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::support {

Recording Joined(const Recording& earlier, const Recording& later) {
  constexpr double kSameRate = 1e-6;
  if (earlier.fingerprint != later.fingerprint || earlier.plant != later.plant)
    throw InputError(earlier.title + ": is a recording of " + earlier.plant + " with other signals than " +
                     later.title + ", which is one of " + later.plant);
  if (std::fabs(earlier.dt - later.dt) > kSameRate * later.dt)
    throw InputError(earlier.title + ": a sample every " + std::to_string(earlier.dt) + " s, and " + later.title +
                     " has one every " + std::to_string(later.dt) + " s: recordings are joined at one rate only");
  Recording joined = later;
  const std::size_t before = earlier.num_rows();
  const auto put_first = [](const auto& first, auto* all) { all->insert(all->begin(), first.begin(), first.end()); };
  put_first(earlier.t, &joined.t);
  put_first(earlier.held_out, &joined.held_out);
  for (std::size_t s = 0; s < joined.signals.size(); ++s) put_first(earlier.signals[s].value, &joined.signals[s].value);
  for (std::size_t& run : joined.runs) run += before;
  put_first(earlier.runs, &joined.runs);
  joined.files.insert(joined.files.begin(), earlier.files.begin(), earlier.files.end());
  joined.smoothed_noise = std::max(earlier.smoothed_noise, later.smoothed_noise);
  // Variances of all rows.
  const double share = static_cast<double>(before) / static_cast<double>(before + later.num_rows());
  const auto both = [share](double first, double second) {
    return std::sqrt(share * first * first + (1.0 - share) * second * second);
  };
  joined.noise_in_samples = both(earlier.noise_in_samples, later.noise_in_samples);
  joined.noise_in_differences = both(earlier.noise_in_differences, later.noise_in_differences);
  joined.notes.push_back("judged together with " + earlier.title + ", " + std::to_string(before) + " rows");
  return joined;
}

}  // namespace armcmc::support
