#pragma once

#include <memory>
#include <string>

#include "armcmc/data_pack.hpp"
#include "armcmc/estimate.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/identify/trajectory_model.hpp"

namespace armcmc::replay {

/// Looks at the first packs of a replay for whether a described plant's states are integrated in short enough steps.
class StepCheck {
 public:
  /// @param plant  Null, or without states: there is nothing to look at.
  /// @param overlap  EstimatorSettings::overlap: of the packs that share a sample one is looked at.
  StepCheck(std::shared_ptr<const PlantProgram> plant, int overlap);

  void Add(const DataPack& pack);
  /// A line that says what to do, for the parameters of the last estimate; empty: the steps are short enough.
  [[nodiscard]] std::string Warning(const Estimator& estimator, const Estimate& last) const;

 private:
  std::shared_ptr<const PlantProgram> plant_;
  int overlap_;
  identify::Series series_;
  std::int64_t last_seq_ = 0, last_run_ = 0;
};

}  // namespace armcmc::replay
