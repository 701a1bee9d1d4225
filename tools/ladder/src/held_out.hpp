#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "armcmc/gap/result.hpp"
#include "armcmc/ladder/climb.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/features.hpp"

namespace armcmc::ladder {

/// A fitted plant over a whole recording.
struct WholeRun {
  std::shared_ptr<const identify::TrajectoryModel> model;
  Eigen::VectorXd prediction, error;  ///< [row]; empty where the law is not finite.
};

[[nodiscard]] WholeRun RunWhole(const Dataset& data, const Trial& trial);

/// Errors on `rows`. @param sd  Standard deviation that the fit claims.
[[nodiscard]] gap::Fit FitOn(const WholeRun& run, const std::vector<Eigen::Index>& rows, double sd);

/// Rows that are kept apart and where a mode acts.
[[nodiscard]] std::vector<Eigen::Index> HeldOutRows(const Dataset& data, const WholeRun& run);

/// Errors on each stretch of them that hangs together, where there are several and not too many.
[[nodiscard]] std::vector<gap::StretchFit> StretchesOf(const Dataset& data, const std::vector<Eigen::Index>& rows,
                                                       const WholeRun& before, const WholeRun& after);

/// Fills the interval of the fraction that is closed on `rows`: bootstrap over stretches of time.
void CloseInterval(const std::vector<Eigen::Index>& rows, const WholeRun& before, const WholeRun& after,
                   std::uint64_t seed, gap::GapSummary* gap);

/// Rows behind the beginning of every run in which a start of states that nobody measured still shows.
void LeaveOutStarts(const Trial& trial, Dataset* data);

/// Curves of the report. `after` may be null.
[[nodiscard]] gap::Figures FiguresOf(const Dataset& data, const WholeRun& before, const WholeRun* after,
                                     const std::vector<Feature>& features, const SignalDescription& output);

}  // namespace armcmc::ladder
