#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "armcmc/identify/fit.hpp"
#include "armcmc/ladder/candidates.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/view.hpp"

namespace armcmc::ladder {

/// Fit of a model, and its errors on left-out rows.
struct Trial {
  std::shared_ptr<const identify::TrajectoryModel> model;
  identify::FitResult fit;
  bool judged = false;                ///< The members below are set.
  std::vector<double> alone;          ///< [group] Squared error of the law on a left-out group.
  std::vector<double> with_flexible;  ///< [group] The same with the flexible function added.
  std::vector<double> rest;           ///< [group] Squared error of that fit on its training rows.
  std::vector<double> stretches;      ///< [segment] Squared error of the law, from the folds.
};

/// Starting points of a fit: the centre of the prior, points around it, and, for a parameter with the unit of a signal,
/// values of that signal.
/// @param known        [parameter] Optimum of the smaller model, for the first parameters; may be empty.
/// @param frequencies  Each adds a start at the strongest frequency of the residual.
[[nodiscard]] std::vector<Eigen::VectorXd> Starts(const identify::TrajectoryModel& model, const Dataset& data,
                                                  const Eigen::VectorXd& known, std::size_t count,
                                                  const std::vector<Frequency>& frequencies = {});

/// Whether the law has memory, i.e. its value at a row depends on earlier rows.
[[nodiscard]] bool Remembers(const Plant& plant);

/// A subset of the data for quick fits: for a simulated plant the beginnings of its runs, otherwise segments, half of
/// them where the model errs most; longer ones if the law has memory.
/// @param error  [row] Residual of a fitted model.
[[nodiscard]] Dataset SubsetForFits(const Plant& plant, const Dataset& data, const Eigen::VectorXd& error);

/// Whether the states of the plant are integrated from the beginning of each run (states of added effects do not
/// count).
[[nodiscard]] bool IsSimulated(const PlantDescription& plant);

/// Default number of rows on which models of a simulated plant are compared, since its fits are slow.
inline constexpr std::size_t kMostSimulated = 8000;

/// The rows on which models are compared: all rows of a short recording; of a long one segments long enough for a law
/// with memory; the beginnings of the runs if the plant is simulated.
/// @param most_simulated  Maximum number of rows of these beginnings.
[[nodiscard]] Dataset Compared(const Plant& plant, const Dataset& data, std::size_t most_simulated = kMostSimulated);

/// Fits a plant to the training rows of `data` from many starts. Rows near the beginning of a run that depend on
/// unmeasured initial states are then removed from the training rows, of `data` as well. The fit is invalid if the law
/// has no finite value.
[[nodiscard]] Trial FitAlone(const std::shared_ptr<const Plant>& plant, Dataset* data);

/// Best fit to the training rows of `data` from `starts` starts and one at each frequency.
[[nodiscard]] Trial Try(const std::shared_ptr<const Plant>& plant, const Dataset& data, const Eigen::VectorXd& known,
                        std::size_t starts, const std::vector<Frequency>& frequencies = {});
/// Fit from `theta`, the result of a fit to other rows.
[[nodiscard]] Trial Refine(const std::shared_ptr<const Plant>& plant, const Dataset& data,
                           const Eigen::VectorXd& theta);

/// Cross-validation of a trial. For every group, the model is refitted to the other rows, from the fit to all rows. The
/// law and the flexible function w are then fitted to them together, linearised about that fit:
///
///   minimise |e - J d - w|^2 + s^2 (|theta + d|^2 of the prior + ridge |weights|^2).
///
/// This measures the gain of an effect when the law itself is allowed to be inexact.
/// @pre trial->fit.valid.
void LeaveOut(const View& view, Trial* trial);

}  // namespace armcmc::ladder
