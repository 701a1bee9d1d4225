#include "confirmation.hpp"

#include <cstddef>
#include <vector>

#include "armcmc/gap/blocks.hpp"
#include "held_out.hpp"

namespace armcmc::ladder {
namespace {

/// Whether the second model is better in nearly every bootstrap sample of blocks of the rows.
bool IsSignificantlyBetter(const WholeRun& first, const WholeRun& second, const std::vector<Eigen::Index>& rows) {
  constexpr double kSurely = 0.99;
  constexpr unsigned long long kSeed = 400;
  if (rows.size() < static_cast<std::size_t>(gap::kNumBlocks)) return false;
  const Eigen::VectorXd gain = gap::BlockSquares(first.error(rows)) - gap::BlockSquares(second.error(rows));
  return gap::BlockBootstrap(kSeed).ProbabilityAbove(gain, 0.0) > kSurely;
}

}  // namespace

HeldOutErrors ConfirmOnHeldOut(const Dataset& data, const Trial& before, const Trial& after, double gain,
                               double noise) {
  constexpr double kAgain = 0.5;
  const WholeRun first = RunWhole(data, before), second = RunWhole(data, after);
  const std::vector<Eigen::Index> rows = HeldOutRows(data, first);
  if (rows.empty()) return {};
  const double was = FitOn(first, rows, 1.0).rmse, is = FitOn(second, rows, 1.0).rmse;
  const double removed = was * was - is * is;
  const bool all_of_it = removed > kAgain * (was * was - noise) && second.error.size() > 0;
  return {was, is, removed > kAgain * gain * was * was || (all_of_it && IsSignificantlyBetter(first, second, rows))};
}

}  // namespace armcmc::ladder
