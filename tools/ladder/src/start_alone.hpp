#pragma once

#include <memory>
#include <optional>

#include "armcmc/ladder/climb.hpp"
#include "rival.hpp"

namespace armcmc::ladder {

/// The part of an effect that comes from the free start values of its states, such as a spring that is stretched when
/// the recording begins. It decays whatever the plant does, so it can imitate a sensor that drifts, and says nothing of
/// how the effect responds to the motion.
class StartAlone {
 public:
  /// All outlive it.
  StartAlone(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, const Trial& base,
             const DataScales& scales);

  /// Compares an effect with the base model to which the effect's response to its start values is added, with a fitted
  /// amplitude. The response to the motion must remove a tenth of the squared error that this leaves, and more than
  /// half of what is not noise.
  /// @param floor  Standard deviation of the noise.
  /// @return a rival if it does not, or if the two cannot be compared; empty if the effect has no free start values, or
  ///   if these change nothing.
  /// @pre c.trial.judged.
  [[nodiscard]] std::optional<Rival> RivalOf(const Contender& c, double floor) const;

 private:
  /// The base model with a response to start values, one value per row. Invalid if it cannot be fitted.
  [[nodiscard]] Trial WithResponse(Eigen::VectorXd response) const;

  const std::shared_ptr<const Plant>& plant_;
  const Dataset& data_;
  const View& view_;
  const Trial& base_;
  const DataScales& scales_;
};

}  // namespace armcmc::ladder
