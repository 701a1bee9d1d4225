#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "armcmc/gap/result.hpp"
#include "armcmc/ladder/climb.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/features.hpp"

namespace armcmc::ladder {

/// Prediction of a fitted plant over a whole recording.
struct WholeRun {
  std::shared_ptr<const identify::TrajectoryModel> model;
  Eigen::VectorXd prediction, error;  ///< [row]; empty if the law is not finite.
};

[[nodiscard]] WholeRun RunWhole(const Dataset& data, const Trial& trial);

/// Errors on `rows`. @param sd  Standard deviation of the error according to the fit.
[[nodiscard]] gap::Fit FitOn(const WholeRun& run, const std::vector<Eigen::Index>& rows, double sd);

/// Held-out rows on which a mode acts.
[[nodiscard]] std::vector<Eigen::Index> HeldOutRows(const Dataset& data, const WholeRun& run);

/// Errors on each contiguous held-out segment; empty if there is only one, or more than 20.
[[nodiscard]] std::vector<gap::SegmentFit> StretchesOf(const Dataset& data, const std::vector<Eigen::Index>& rows,
                                                       const WholeRun& before, const WholeRun& after);

/// Sets the 95 % interval of the closed fraction on `rows`, by a bootstrap over blocks of time.
void CloseInterval(const std::vector<Eigen::Index>& rows, const WholeRun& before, const WholeRun& after,
                   std::uint64_t seed, gap::GapSummary* gap);

/// Removes from the training rows those at the beginning of every run on which unmeasured initial states still have an
/// influence.
void LeaveOutStarts(const Trial& trial, Dataset* data);

/// Curves of the report. @param after  May be null.
[[nodiscard]] gap::Figures FiguresOf(const Dataset& data, const WholeRun& before, const WholeRun* after,
                                     const std::vector<Feature>& features, const SignalDescription& output);

}  // namespace armcmc::ladder
