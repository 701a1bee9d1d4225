#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "armcmc/identify/fit.hpp"
#include "armcmc/ladder/candidates.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/view.hpp"

namespace armcmc::ladder {

/// What a model makes of the data.
struct Trial {
  std::shared_ptr<const identify::TrajectoryModel> model;
  identify::FitResult fit;
  bool judged = false;            ///< What follows is there.
  std::vector<double> alone;      ///< [group] Squared error of the law on a group that it was not fitted to.
  std::vector<double> beside;     ///< [group] The same with the flexible function beside it.
  std::vector<double> rest;       ///< [group] Squared error of that fit on the rows that it saw.
  std::vector<double> stretches;  ///< [short stretch] Of the law, in folds.
};

/// Parameter vectors to begin a fit with: the prior's centre, and others about it; for parameters with the unit of a
/// signal also values of that signal.
/// @param known        [parameter] The first ones, where a smaller model has its best; may be empty.
/// @param frequencies  One more start each, at the strongest one of what is not explained.
[[nodiscard]] std::vector<Eigen::VectorXd> Starts(const identify::TrajectoryModel& model, const Dataset& data,
                                                  const Eigen::VectorXd& known, std::size_t count,
                                                  const std::vector<Frequency>& frequencies = {});

/// True where the law at one row depends on earlier ones.
[[nodiscard]] bool Remembers(const Plant& plant);

/// A part of the data on which a fit is quick: of a plant that is simulated the beginnings of its runs, else stretches
/// where a model errs and others, longer where the law remembers.
/// @param error  [row] Of a model that has been fitted.
[[nodiscard]] Dataset QuickPart(const Plant& plant, const Dataset& data, const Eigen::VectorXd& error);

/// True for a plant whose own states are integrated from the beginning of a run, not those of an effect only.
[[nodiscard]] bool IsSimulated(const PlantDescription& plant);

/// Rows on which simulated plants are compared, where nothing else is asked for: fits take long.
inline constexpr std::size_t kMostSimulated = 8000;

/// The rows on which models are compared: all of a short recording, stretches of a long one that a law with memory can
/// follow, beginnings where the plant is simulated.
/// @param most_simulated  Rows of those beginnings, at most.
[[nodiscard]] Dataset Compared(const Plant& plant, const Dataset& data, std::size_t most_simulated = kMostSimulated);

/// A plant as it is, fitted to the training rows of `data`, from many starts; then those near the beginning of a run
/// that depend on states nobody measured do not count any more, in `data` neither. Not valid where the law has no
/// finite value.
[[nodiscard]] Trial FitAlone(const std::shared_ptr<const Plant>& plant, Dataset* data);

/// Best of fits to the training rows of `data` from `starts` starts, and one at each frequency.
[[nodiscard]] Trial Try(const std::shared_ptr<const Plant>& plant, const Dataset& data, const Eigen::VectorXd& known,
                        std::size_t starts, const std::vector<Frequency>& frequencies = {});
/// A fit that begins where one on other rows ended.
[[nodiscard]] Trial Refine(const std::shared_ptr<const Plant>& plant, const Dataset& data,
                           const Eigen::VectorXd& theta);

/// Judges a trial: for every group a fit to the other rows, from the fit to all; then about it, to the other
/// rows again, law and flexible function w together,
///
///   minimise |e - J d - w|^2 + s^2 (|theta + d|^2 of the prior + ridge |weights|^2),
///
/// as a law that is a little off would be used by somebody who knows that it is.
/// @pre trial->fit.valid.
void LeaveOut(const View& view, Trial* trial);

}  // namespace armcmc::ladder
