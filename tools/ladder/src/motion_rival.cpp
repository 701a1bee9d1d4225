#include "motion_rival.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "action.hpp"

namespace armcmc::ladder {
namespace {

/// Share of the square of a function of time that the flexible function predicts on left-out segments. At most 1;
/// negative if it predicts worse than zero does.
/// @param value  [active row] Its mean is not counted.
double PredictedShare(const View& view, const Eigen::VectorXd& value) {
  constexpr double kRidge = 1.0;  // the prior of the flexible function: weights of the size of what is predicted
  const double square = value.squaredNorm() / static_cast<double>(value.size());
  if (!(square > 0.0)) return 0.0;
  const Eigen::VectorXd scaled = (value.array() - value.mean()) / std::sqrt(square);
  Eigen::MatrixXd whole = view.flexible.transpose() * view.flexible;
  whole.diagonal().array() += kRidge;
  const Eigen::VectorXd right = view.flexible.transpose() * scaled;
  double left = 0.0, all = 0.0;
  for (const RowGroup& group : view.groups) {
    if (group.kind != GroupKind::kFold) continue;
    const Eigen::MatrixXd part = view.flexible(group.rows, Eigen::all);
    const Eigen::VectorXd there = scaled(group.rows);
    const Eigen::MatrixXd without = whole - part.transpose() * part;
    const Eigen::VectorXd weights = without.ldlt().solve(right - part.transpose() * there);
    left += (there - part * weights).squaredNorm();
    all += there.squaredNorm();
  }
  return all > 0.0 ? 1.0 - left / all : 0.0;
}

}  // namespace

std::optional<Rival> MotionRivalOf(const View& view, const Trial& base, const Contender& c) {
  constexpr double kMost = 0.5;
  if (c.candidate.Frequencies().empty() || !IsIndependentOfSignals(c.candidate)) return std::nullopt;
  const Eigen::VectorXd added = (c.trial.fit.prediction - base.fit.prediction)(view.active_rows);
  if (PredictedShare(view, added) <= kMost) return std::nullopt;
  return Rival{"the motion were its cause", "predicts more than half of it"};
}

}  // namespace armcmc::ladder
