#include "armcmc/end_of_pack.hpp"

namespace armcmc {

EndOfPack::EndOfPack(const Quantiles& effective, const Quantiles& end, double offset, double lower,
                     double upper) noexcept {
  line_.lower = lower;
  line_.upper = upper;
  line_.slope = (end[1] - end[0]) / (effective[1] - effective[0]);
  line_.constant = end[0] + offset - line_.slope * (effective[0] + offset);
  double before = line_.slope;
  for (std::size_t k = 0; k < kBends; ++k) {
    const double slope = (end[k + 2] - end[k + 1]) / (effective[k + 2] - effective[k + 1]);
    line_.at[k] = effective[k + 1] + offset;
    line_.bend[k] = slope - before;
    line_.constant -= line_.bend[k] * line_.at[k];
    before = slope;
  }
}

EndOfPack::EndOfPack(double mean, double shift, double ratio, double lower, double upper) noexcept
    : line_{.constant = (1.0 - ratio) * mean + shift,
            .slope = ratio,
            .at = {},
            .bend = {},
            .lower = lower,
            .upper = upper} {}

bool EndOfPack::IsFinite() const noexcept {
  double sum = line_.constant + line_.slope;
  for (std::size_t k = 0; k < kBends; ++k) sum += line_.at[k] + line_.bend[k];
  return std::isfinite(sum);
}

}  // namespace armcmc
