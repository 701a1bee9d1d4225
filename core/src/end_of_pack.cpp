#include "armcmc/end_of_pack.hpp"

namespace armcmc {

EndOfPack::EndOfPack(const Quantiles& effective, const Quantiles& end, double offset, double outer_slope, double lower,
                     double upper) noexcept {
  line_.lower = lower;
  line_.upper = upper;
  line_.slope = outer_slope;
  line_.constant = end[0] + offset - line_.slope * (effective[0] + offset);
  double before = line_.slope;
  for (std::size_t k = 0; k < kBends; ++k) {
    const double slope = k + 1 < kBends ? (end[k + 1] - end[k]) / (effective[k + 1] - effective[k]) : line_.slope;
    line_.at[k] = effective[k] + offset;
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
