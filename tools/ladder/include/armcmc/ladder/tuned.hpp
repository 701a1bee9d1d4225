#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/ladder/trial.hpp"
#include "armcmc/plant/description.hpp"
#include "armcmc/plant/program.hpp"

namespace armcmc::ladder {

/// A plant as the estimator can go on with it.
struct TunedPlant {
  PlantDescription plant;
  PlantDescription loose;                       ///< The same with the priors that it had.
  std::vector<std::string> held;                ///< Parameters that are constants now.
  std::shared_ptr<const PlantProgram> program;  ///< Null: the estimator cannot run it,
  std::string why_not;                          ///< because of this.
};

/// The plant with its priors about a fit: means there, standard deviations of three times what these data leave open,
/// since the next run is another one; never wider than the file's. (Where real data contradict a model in one pack, the
/// estimator begins anew from its prior. From ten times as wide a one it predicts the next pack up to three times
/// worse.)
///
/// A parameter of an effect is held at the fit, as a constant, where the data leave it more than a quarter as wide as
/// its prior, the widest first and the others looked at again without it: an estimator that has to learn from one pack
/// at a time would let those that the data cannot tell apart wander about. So are further ones where there are more
/// than the estimator samples. And so is any parameter that the fit presses against a bound, where what the data say of
/// it has another shape than a prior about the fit.
/// @param own   Parameters that the plant had before any effect, which come first and are held on a bound only.
/// @param rows  [row] 1: the fit was made to it.
[[nodiscard]] TunedPlant Tuned(const PlantDescription& plant, std::size_t own, const Trial& trial,
                               const std::vector<std::uint8_t>& rows);

}  // namespace armcmc::ladder
