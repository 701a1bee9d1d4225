#include "armcmc/gap/verify.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace armcmc::gap {
namespace {

constexpr double kBand95 = 1.959963984540054;
constexpr int kLags = 25;

Vector Rows(const Vector& v, Eigen::Index first) { return v.tail(v.size() - first); }

/// An equation may have no column at all: Eigen takes no rows from nothing.
Matrix RowsOf(const Matrix& m, Eigen::Index first) {
  if (m.cols() == 0) return Matrix(m.rows() - first, 0);
  return m.bottomRows(m.rows() - first);
}

Signals Tail(const Signals& all, Eigen::Index first) {
  Signals tail = all;
  tail.t = Rows(all.t, first);
  tail.output = Rows(all.output, first);
  tail.active = Rows(all.active, first);
  for (std::size_t r = 0; r < kNumRoles; ++r)
    if (all.input[r].size() > 0) tail.input[r] = Rows(all.input[r], first);
  return tail;
}

double LjungBox(const Vector& series) {
  const Vector w = series.array() - series.mean();
  const auto n = static_cast<double>(w.size());
  double sum = 0.0;
  for (int lag = 1; lag <= kLags; ++lag) {
    const double r = w.head(w.size() - lag).dot(w.tail(w.size() - lag)) / w.squaredNorm();
    sum += r * r / (n - lag);
  }
  return n * (n + 2.0) * sum / kLags;
}

double QuantileOf(Vector values, double q) {
  const auto at = static_cast<Eigen::Index>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.data(), values.data() + at, values.data() + values.size());
  return values[at];
}

double Rms(const Vector& v) {
  return std::sqrt(v.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(v.size(), 1)));
}

ModeFit OfMode(const std::string& name, const Vector& mask, const Vector& before, const Vector& after) {
  const double count = mask.sum();
  const auto rms = [&](const Vector& e) {
    return std::sqrt((e.array().square() * mask.array()).sum() / std::max(count, 1.0));
  };
  return {name, static_cast<int>(count), rms(before), rms(after)};
}

/// Whether a series contains another as it is: the slope of the regression on it is one, give or take a third.
bool IsAsPredicted(const Vector& series, const Vector& added, const BlockBootstrap& bootstrap) {
  constexpr double kOff = 1.5;  // formulas for the same physics differ by a third
  const Vector size = BlockSquares(added);
  if (!(size.sum() > 0.0)) return false;
  const Vector found = 0.25 * (BlockSquares(added + series) - BlockSquares(added - series));
  return bootstrap.RatioQuantile(found, size, 0.025) > 1.0 / kOff && bootstrap.RatioQuantile(found, size, 0.975) < kOff;
}

}  // namespace

HeldOut::HeldOut(const Equation& equation, const Analysis& analysis, const Recording& recording, Eigen::Index first)
    : equation_(&equation),
      analysis_(&analysis),
      all_(equation.PrepareLike(recording, analysis.signals.window, analysis.signals)),
      tail_(Tail(all_, first)),
      first_(first) {
  if (tail_.rows() < kNumBlocks)
    throw std::invalid_argument(recording.source + ": holds " + std::to_string(tail_.rows()) + " samples; at least " +
                                std::to_string(kNumBlocks) + " are needed to show a gap on");
}

Trial HeldOut::Try(const Fitted& fitted) const {
  const Whitener& whitener = analysis_->fitter->whitener();
  const Prediction p = Evaluate(*equation_, all_, fitted.hypothesis, fitted.theta);
  Trial trial;
  trial.predicted = Rows(p.y, first_);
  trial.residual = Rows(Vector(all_.output - p.y), first_);
  trial.whitened = Rows(whitener.Apply(Vector(all_.output - p.y)), first_);
  trial.whitened_jacobian = RowsOf(whitener.Apply(p.jacobian), first_);
  const Matrix tail = RowsOf(p.jacobian, first_);
  Vector parameters = Vector::Zero(tail.rows());
  if (tail.cols() > 0) parameters = (tail * fitted.Covariance(whitener.variance)).cwiseProduct(tail).rowwise().sum();
  trial.band_sd = (parameters.cwiseMax(0.0).array() + whitener.variance * whitener.Gain()).sqrt();
  return trial;
}

Fit HeldOut::Judge(const Trial& trial) const {
  const Vector size = trial.residual.cwiseAbs();
  Fit fit;
  fit.rmse = Rms(trial.residual);
  fit.mae = size.mean();
  fit.worst_1_percent = QuantileOf(size, 0.99);
  fit.coverage95 = (size.array() <= kBand95 * trial.band_sd.array()).cast<double>().mean();
  fit.whiteness = LjungBox(trial.whitened);
  return fit;
}

double HeldOut::NoiseFloor(const Trial& after) const {
  for (const auto& [predicted, floor] : floors_)
    if (predicted == after.predicted) return floor;
  floors_.emplace_back(after.predicted, MeasureNoiseFloor(after));
  return floors_.back().second;
}

double HeldOut::MeasureNoiseFloor(const Trial& after) const {
  // The parameters may be wrong on these data, too: their columns are among those that are penalised, none is free.
  const Whitener& whitener = analysis_->fitter->whitener();
  const Fitter fitter(*equation_, tail_, whitener);
  const AdequacyCheck adequacy_check(fitter, after.predicted);
  Fitted as_it_is;
  as_it_is.whitened_residual = after.whitened;
  as_it_is.whitened_jacobian = Matrix(after.whitened.size(), 0);
  as_it_is.heldout = -0.5 / whitener.variance * BlockSquares(after.whitened);
  const Vector gain = adequacy_check.GainOfAll(as_it_is, after.whitened_jacobian);
  const double squares = after.whitened.squaredNorm();
  const double explained = std::clamp(2.0 * whitener.variance * gain.sum(), 0.0, squares);
  return Rms(after.residual) * std::sqrt(1.0 - explained / squares);
}

double HeldOut::ClosedOutsideWorstBlocks(const Fitted& before, const Fitted& after) const {
  constexpr Eigen::Index kKept = kNumBlocks - kNumBlocks / 5;
  const Whitener& whitener = analysis_->fitter->whitener();
  const Vector first = BlockSquares(Try(before).residual), second = BlockSquares(Try(after).residual);
  std::vector<Eigen::Index> order(kNumBlocks);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return second[a] < second[b]; });
  order.resize(kKept);
  const double noise =
      whitener.variance * whitener.Gain() * static_cast<double>(tail_.rows()) * kKept / static_cast<double>(kNumBlocks);
  const double gap = first(order).sum() - noise;
  return gap > 0.0 ? (first(order).sum() - second(order).sum()) / gap : 0.0;
}

bool HeldOut::FoundAsPredicted(const Fitted& before, const Fitted& after, const BlockBootstrap& bootstrap) const {
  const Trial trial = Try(before);
  const Eigen::ColPivHouseholderQR<Matrix> parameters(trial.whitened_jacobian);
  const auto beyond_parameters = [&](const Vector& y) {
    return Vector(y - trial.whitened_jacobian * parameters.solve(y));
  };
  return IsAsPredicted(beyond_parameters(trial.whitened), beyond_parameters(trial.whitened - Try(after).whitened),
                       bootstrap);
}

bool HeldOut::FoundBesideLawError(const Fitted& before, const Fitted& after, const BlockBootstrap& bootstrap,
                                  double least) const {
  const Trial trial = Try(before);
  const Matrix& columns = trial.whitened_jacobian;
  Matrix gram = columns.transpose() * columns;
  gram.noalias() += before.whitened_jacobian.transpose() * before.whitened_jacobian;
  gram.diagonal() *= 1.0 + 1e-9;
  const Eigen::LDLT<Matrix> parameters(gram);
  const auto beyond_parameters = [&](const Vector& y) {
    return Vector(y - columns * parameters.solve(columns.transpose() * y));
  };
  const Vector first = beyond_parameters(trial.whitened);
  const Vector added = beyond_parameters(trial.whitened - Try(after).whitened);
  const double noise = analysis_->fitter->whitener().variance * static_cast<double>(first.size());
  const double gap = first.squaredNorm() - noise, closed = first.squaredNorm() - (first - added).squaredNorm();
  return closed > least * std::max(gap, 0.0) && IsAsPredicted(first, added, bootstrap);
}

GapSummary ShowGap(const Equation& equation, const HeldOut& data, const BlockBootstrap& bootstrap, const Fitted& before,
                   const Fitted& after, const Fitted* control) {
  const Trial first = data.Try(before), second = data.Try(after);
  GapSummary gap;
  gap.unit = equation.output_unit();
  gap.before = data.Judge(first);
  gap.after = data.Judge(second);
  gap.noise_floor = data.NoiseFloor(second);
  const double floor = gap.noise_floor * gap.noise_floor;
  const auto closed = [&](const Trial& trial) {
    const double mse0 = std::pow(Rms(first.residual), 2), mse = std::pow(Rms(trial.residual), 2);
    return mse0 > floor ? (mse0 - mse) / (mse0 - floor) : 0.0;
  };
  gap.closed_fraction = closed(second);
  const auto rows = static_cast<double>(first.residual.size());
  const Vector total = BlockSquares(first.residual).array() - floor * rows / kNumBlocks;
  const Vector gained = BlockSquares(first.residual) - BlockSquares(second.residual);
  gap.closed_low = bootstrap.RatioQuantile(gained, total, 0.025);
  gap.closed_high = bootstrap.RatioQuantile(gained, total, 0.975);
  gap.gap_ratio = std::sqrt(std::max(gap.before.rmse * gap.before.rmse / std::max(floor, 1e-300) - 1.0, 0.0));
  const Vector& active = data.signals().active;
  gap.modes = {OfMode(equation.active_name(), active, first.residual, second.residual),
               OfMode(equation.passive_name(), 1.0 - active.array(), first.residual, second.residual)};
  if (control != nullptr) {
    std::string names;
    for (const Term& term : control->hypothesis.terms) names += (names.empty() ? "" : " + ") + TermText(term);
    gap.control_effects = names;
    gap.control_closed_fraction = closed(data.Try(*control));
  }
  return gap;
}

}  // namespace armcmc::gap
