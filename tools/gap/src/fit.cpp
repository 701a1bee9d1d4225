#include "armcmc/gap/fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>

#include "gram.hpp"

namespace armcmc::gap {
namespace {

constexpr double kTolerance = 1e-6;  // relative decrease of the squares that ends a fit: 0.005 nats of 10 000 rows
constexpr int kMaxDampings = 6;
constexpr double kLeastDamping = 1e-6;
constexpr double kSameMinimum = 25.0;     // squared standard deviations from a minimum that was found before
constexpr int kStepsForHope = 2;          // steps before the expected decrease is judged
constexpr double kHope = 4.0;             // times what the tangent bounds, short of which a descent is given up
constexpr double kSmallAmplitude = 1e-3;  // start of an amplitude that is zero at its bound
constexpr std::size_t kRefinedStarts = 2;

void Clamp(const std::vector<Coordinate>& coordinates, Vector* theta) {
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    double& value = (*theta)[static_cast<Eigen::Index>(i)];
    value = std::clamp(value, coordinates[i].lower, coordinates[i].upper);
  }
}

/// Coordinates that rest on a bound and are pushed against it.
std::vector<bool> Blocked(const std::vector<Coordinate>& coordinates, const Vector& theta, const Vector& ascent) {
  std::vector<bool> blocked(coordinates.size());
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    blocked[i] = (theta[k] <= coordinates[i].lower && ascent[k] <= 0.0) ||
                 (theta[k] >= coordinates[i].upper && ascent[k] >= 0.0);
  }
  return blocked;
}

std::vector<Eigen::Index> FreeOf(const std::vector<bool>& blocked) {
  std::vector<Eigen::Index> free;
  for (std::size_t i = 0; i < blocked.size(); ++i)
    if (!blocked[i]) free.push_back(static_cast<Eigen::Index>(i));
  return free;
}

/// Damped Gauss-Newton step of the free coordinates. One that would leave its bounds goes to its bound and the others
/// answer to that: were the whole step cut, what they gained on the promise of the part cut off would be lost.
Vector BoundedStep(const Matrix& gram, const Vector& ascent, double damping, const std::vector<Coordinate>& coordinates,
                   const Vector& theta, std::vector<Eigen::Index> free) {
  Vector step = Vector::Zero(theta.size());
  while (!free.empty()) {
    Matrix damped = gram(free, free);
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-300;
    const Vector inner = damped.ldlt().solve(ascent(free) - gram(free, Eigen::all) * step);
    std::vector<Eigen::Index> inside;
    for (std::size_t i = 0; i < free.size(); ++i) {
      const Eigen::Index k = free[i];
      const Coordinate& c = coordinates[static_cast<std::size_t>(k)];
      const double target = theta[k] + inner[static_cast<Eigen::Index>(i)];
      if (target < c.lower || target > c.upper)
        step[k] = std::clamp(target, c.lower, c.upper) - theta[k];
      else
        inside.push_back(k);
    }
    if (inside.size() == free.size()) {
      step(free) = inner;
      break;
    }
    free = std::move(inside);
  }
  return step;
}

/// What is known beforehand of the shapes of effects that an amplitude scales; zero of all other coordinates. One
/// reversal may tell the width of a friction: without its block the fit must not run where the tangent means nothing.
Vector ShapePrecision(const Fitted& fitted) {
  Vector precision = Vector::Zero(fitted.theta.size());
  Eigen::Index end = fitted.theta.size();
  for (auto term = fitted.hypothesis.terms.rbegin(); term != fitted.hypothesis.terms.rend(); ++term) {
    const EffectForm& form = *term->form;
    end -= form.size();
    for (int i = form.num_amplitudes; form.linear && i < form.size(); ++i) {
      const double sd = fitted.coordinates[static_cast<std::size_t>(end + i)].prior_sd;
      precision[end + i] = 1.0 / (sd * sd);
    }
  }
  return precision;
}

/// What is known beforehand of many small amplitudes, whose mean is zero; zero of all other coordinates.
Vector RegularPrecision(const Hypothesis& hypothesis, const std::vector<Coordinate>& coordinates) {
  auto end = static_cast<Eigen::Index>(coordinates.size());
  Vector precision = Vector::Zero(end);
  for (auto term = hypothesis.terms.rbegin(); term != hypothesis.terms.rend(); ++term) {
    end -= term->form->size();
    for (int i = 0; term->form->regular && i < term->form->size(); ++i)
      precision[end + i] = std::pow(coordinates[static_cast<std::size_t>(end + i)].prior_sd, -2);
  }
  return precision;
}

}  // namespace

Matrix OrthonormalBasis(const Matrix& columns) {
  if (columns.cols() == 0) return columns;
  Matrix scaled = columns;
  for (Eigen::Index c = 0; c < scaled.cols(); ++c) scaled.col(c) /= scaled.col(c).norm() + 1e-300;
  Eigen::ColPivHouseholderQR<Matrix> qr(scaled);
  qr.setThreshold(1e-10);
  if (qr.rank() == 0) return Matrix(scaled.rows(), 0);
  return qr.householderQ() * Matrix::Identity(scaled.rows(), qr.rank());
}

const Matrix& Fitted::basis() const {
  if (!basis_) basis_ = std::make_shared<const Matrix>(OrthonormalBasis(whitened_jacobian));
  return *basis_;
}

double Fitted::CostOfLeavingOut(Eigen::Index coordinate) const {
  std::vector<Eigen::Index> others = FreeOf(at_bound);
  std::erase(others, coordinate);
  const Matrix basis = OrthonormalBasis(whitened_jacobian(Eigen::all, others));
  Vector column = whitened_jacobian.col(coordinate);
  column -= basis * (basis.transpose() * column);
  const double way =
      coordinates[static_cast<std::size_t>(coordinate)].prior_mean - theta[coordinate];  // to where nothing is known
  const double variance = squares / static_cast<double>(whitened_residual.size()) + 1e-300;
  return (0.5 * way * way * column.squaredNorm() - way * column.dot(whitened_residual)) / variance;
}

bool Fitted::on_edge() const {
  constexpr double kNear = 1e-3;   // of the range
  constexpr double kSilent = 0.1;  // nats; below this the data do not determine the coordinate
  constexpr double kChance = 2.0;  // two standard deviations: so far a state at the start may stray by noise
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const Coordinate& c = coordinates[i];
    const auto k = static_cast<Eigen::Index>(i);
    const double at = theta[k], near = kNear * (c.upper - c.lower);
    const bool rests = (c.other_below && at < c.lower + near) || (c.other_above && at > c.upper - near);
    const bool mean_beyond = c.prior_mean < c.lower || c.prior_mean > c.upper;  // there is no way back to it
    if (rests && (mean_beyond || CostOfLeavingOut(k) > (c.event ? kChance : kSilent))) return true;
  }
  return false;
}

Matrix Fitted::Covariance(double variance) const {
  std::vector<bool> fixed = at_bound;
  for (std::size_t i = 0; i < fixed.size(); ++i)
    if (coordinates[i].event) fixed[i] = whitened_jacobian.col(static_cast<Eigen::Index>(i)).isZero(0.0);
  const std::vector<Eigen::Index> free = FreeOf(fixed);
  Matrix covariance = Matrix::Zero(theta.size(), theta.size());
  if (free.empty()) return covariance;
  const Matrix columns = whitened_jacobian(Eigen::all, free);
  Matrix gram = columns.transpose() * columns;
  gram.diagonal() *= 1.0 + 1e-12;
  covariance(free, free) = variance * gram.ldlt().solve(Matrix::Identity(gram.rows(), gram.cols()));
  return covariance;
}

Fitter::Fitter(const Equation& equation, const Signals& signals, Whitener whitener)
    : equation_(&equation), signals_(&signals), whitener_(std::move(whitener)) {}

Prediction Fitter::Predict(const Hypothesis& hypothesis, const Vector& theta, Slopes wanted) const {
  std::unique_ptr<LawMemo> memo = memos_.Take();
  Prediction prediction = Evaluate(*equation_, *signals_, hypothesis, theta, wanted, memo.get());
  memos_.Give(std::move(memo));
  return prediction;
}

std::unique_ptr<LawMemo> Fitter::Memos::Take() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) return std::make_unique<LawMemo>();
  std::unique_ptr<LawMemo> memo = std::move(idle_.back());
  idle_.pop_back();
  return memo;
}

void Fitter::Memos::Give(std::unique_ptr<LawMemo> memo) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(memo));
}

/// A descent: where it is, and what is known there.
struct Fitter::Descent {
  std::vector<Coordinate> coordinates;
  Vector theta;
  Prediction prediction;
  Vector residual;        ///< Whitened.
  Matrix columns;         ///< Whitened derivatives there; empty: not made yet.
  bool hopeless = false;  ///< It was given up for its rival.
};

Fitter::Descent Fitter::Descend(const Hypothesis& hypothesis, const Vector& start, int max_steps,
                                const CoordinatePrior* prior, const Fitted* rival) const {
  Descent at{CoordinatesOf(*equation_, *signals_, hypothesis), start, {}, {}, {}};
  Clamp(at.coordinates, &at.theta);
  CoordinatePrior regular;
  if (prior == nullptr && std::any_of(hypothesis.terms.begin(), hypothesis.terms.end(),
                                      [](const Term& term) { return term.form->regular; })) {
    regular = {Vector::Zero(at.theta.size()), RegularPrecision(hypothesis, at.coordinates).asDiagonal()};
    prior = &regular;
  }
  at.prediction = Predict(hypothesis, at.theta);
  at.residual = whitener_.Apply(Vector(signals_->output - at.prediction.y));
  const auto penalty = [&](const Vector& theta) {
    return prior == nullptr ? 0.0
                            : whitener_.variance * (theta - prior->mean).dot(prior->precision * (theta - prior->mean));
  };
  double squares = at.residual.squaredNorm() + penalty(at.theta);
  double damping = kLeastDamping;
  for (int step = 0; step < max_steps; ++step) {
    at.columns = whitener_.Apply(at.prediction.jacobian);
    Vector ascent = at.columns.transpose() * at.residual;
    Matrix gram = GramOf(at.columns, 0, at.columns.rows());
    if (prior != nullptr) {
      ascent += whitener_.variance * (prior->precision * (prior->mean - at.theta));
      gram += whitener_.variance * prior->precision;
    }
    const std::vector<Eigen::Index> free = FreeOf(Blocked(at.coordinates, at.theta, ascent));
    if (free.empty()) break;
    if (rival != nullptr) {
      const Vector way = rival->theta - at.theta;
      const Vector promised = BoundedStep(gram, ascent, kLeastDamping, at.coordinates, at.theta, free);
      at.hopeless = way.dot(gram * way) < kSameMinimum * whitener_.variance ||
                    (step >= kStepsForHope && squares - kHope * ascent.dot(promised) > rival->squares);
      if (at.hopeless) return at;
    }
    bool improved = false;
    double decrease = 0.0;
    for (int i = 0; i < kMaxDampings && !improved; ++i) {
      Vector tried = at.theta + BoundedStep(gram, ascent, damping, at.coordinates, at.theta, free);
      Clamp(at.coordinates, &tried);
      Prediction next = Predict(hypothesis, tried);
      Vector next_residual = whitener_.Apply(Vector(signals_->output - next.y));
      const double next_squares = next_residual.squaredNorm() + penalty(tried);
      if (!(next_squares < squares)) {
        damping = std::max(10.0 * damping, 1e-4);
        continue;
      }
      improved = true;
      decrease = (squares - next_squares) / squares;
      at.theta = tried;
      at.prediction = std::move(next);
      at.columns.resize(0, 0);
      at.residual = std::move(next_residual);
      squares = next_squares;
      damping = std::max(0.2 * damping, 1e-8);
    }
    if (!improved || decrease < kTolerance) break;
  }
  return at;
}

Fitted Fitter::Finish(const Hypothesis& hypothesis, Descent at) const {
  Fitted fitted;
  fitted.hypothesis = hypothesis;
  fitted.coordinates = std::move(at.coordinates);
  fitted.theta = std::move(at.theta);
  fitted.whitened_jacobian = at.columns.size() > 0 ? std::move(at.columns) : whitener_.Apply(at.prediction.jacobian);
  fitted.predicted = std::move(at.prediction.y);
  fitted.whitened_residual = std::move(at.residual);
  fitted.squares = fitted.whitened_residual.squaredNorm();
  Score(&fitted);
  return fitted;
}

Fitted Fitter::Fit(const Hypothesis& hypothesis, const Vector& start, int max_steps,
                   const CoordinatePrior* prior) const {
  return Finish(hypothesis, Descend(hypothesis, start, max_steps, prior, nullptr));
}

void Fitter::Score(Fitted* fitted) const {
  const Vector ascent = fitted->whitened_jacobian.transpose() * fitted->whitened_residual;
  fitted->at_bound = Blocked(fitted->coordinates, fitted->theta, ascent);
  // A shape of an amplitude of zero has no column either.
  for (std::size_t i = 0; i < fitted->at_bound.size(); ++i)
    if (fitted->whitened_jacobian.col(static_cast<Eigen::Index>(i)).isZero(0.0) || fitted->coordinates[i].event ||
        fitted->coordinates[i].nuisance)
      fitted->at_bound[i] = true;
  const std::vector<Eigen::Index> free = FreeOf(fitted->at_bound);
  const BlockGrams grams = MakeGrams(fitted->whitened_jacobian, fitted->whitened_residual);
  const Vector ridge = whitener_.variance * ShapePrecision(*fitted)(free);
  fitted->heldout = -0.5 / whitener_.variance * LeaveBlockOut(grams.Only(free), ridge);

  // Laplace: the Hessian of the log posterior at the fit, prior included.
  Matrix hessian = grams.TotalGram() / whitener_.variance;
  double log_prior = 0.0;
  for (std::size_t i = 0; i < fitted->coordinates.size(); ++i) {
    const Coordinate& c = fitted->coordinates[i];
    const auto k = static_cast<Eigen::Index>(i);
    const double precision = 1.0 / (c.prior_sd * c.prior_sd);
    const double off = fitted->theta[k] - c.prior_mean;
    hessian(k, k) += precision;
    log_prior += 0.5 * std::log(precision) - 0.5 * off * off * precision;
  }
  const Vector pivots = hessian.ldlt().vectorD().cwiseMax(1e-300);
  fitted->log_evidence = -0.5 * fitted->squares / whitener_.variance + log_prior - 0.5 * pivots.array().log().sum();
}

void Fitter::ShrinkUntilFinite(const Hypothesis& hypothesis, Eigen::Index first, int count, Vector* theta) const {
  constexpr int kMostHalvings = 20;
  for (int i = 0; i < kMostHalvings; ++i) {
    if (Predict(hypothesis, *theta, Slopes::None()).y.allFinite()) return;
    theta->segment(first, count) *= 0.5;
  }
}

std::vector<std::pair<double, Vector>> Fitter::Starts(const Fitted& parent, const Term& term) const {
  const EffectForm& form = *term.form;
  Hypothesis hypothesis = parent.hypothesis;
  hypothesis.terms.push_back(term);
  const Eigen::Index first = parent.theta.size();
  const Matrix& basis = parent.basis();
  const auto project = [&](const Matrix& columns) -> Matrix { return columns - basis * (basis.transpose() * columns); };

  std::vector<std::pair<double, Vector>> starts;
  std::vector<std::vector<double>> grid = form.starts;
  if (form.find_starts)
    for (std::vector<double>& start : form.find_starts(*signals_, parent.whitened_residual))
      grid.push_back(std::move(start));
  const std::vector<Coordinate> coordinates = CoordinatesOf(*equation_, *signals_, hypothesis);
  const bool only_adds = LastOnlyAdds(hypothesis);
  const auto by_amplitudes = [&](const Vector& theta) -> Matrix {
    if (only_adds) return Features(*signals_, term, theta.data() + first + form.num_amplitudes);
    const Slopes wanted{static_cast<int>(first), static_cast<int>(first) + form.num_amplitudes};
    return Predict(hypothesis, theta, wanted).jacobian.middleCols(first, form.num_amplitudes);
  };
  for (const std::vector<double>& start : grid) {
    Vector theta(first + form.size());
    theta << parent.theta, Eigen::Map<const Vector>(start.data(), form.size());
    double squares = 0.0;
    if (form.linear) {
      theta.segment(first, form.num_amplitudes).setZero();
      const Matrix columns = project(whitener_.Apply(by_amplitudes(theta)));
      Matrix gram = columns.transpose() * columns;
      gram.diagonal().array() += 1e-12 * gram.trace() + 1e-300;
      Vector amplitudes = gram.ldlt().solve(columns.transpose() * parent.whitened_residual);
      for (int a = 0; a < form.num_amplitudes; ++a) {
        const Coordinate& c = form.coordinates[static_cast<std::size_t>(a)];
        amplitudes[a] = std::clamp(amplitudes[a], c.lower, c.upper);
      }
      squares = (parent.whitened_residual - columns * amplitudes).squaredNorm();
      // An amplitude of zero has no slope by its shapes.
      if (amplitudes.isZero(0.0)) amplitudes[0] = kSmallAmplitude;
      theta.segment(first, form.num_amplitudes) = amplitudes;
    } else {
      const Vector step = whitener_.Apply(Vector(Predict(hypothesis, theta, Slopes::None()).y - parent.predicted));
      squares = (parent.whitened_residual - project(step).col(0)).squaredNorm();
    }
    Clamp(coordinates, &theta);
    starts.emplace_back(squares, theta);
  }
  std::sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return starts;
}

double Fitter::LeastDecrease(const Fitted& parent, const Term& term) const {
  return parent.squares - Starts(parent, term).front().first;
}

Fitted Fitter::Add(const Fitted& parent, const Term& term) const {
  Hypothesis hypothesis = parent.hypothesis;
  hypothesis.terms.push_back(term);
  std::vector<std::pair<double, Vector>> starts = Starts(parent, term);
  starts.resize(std::min(kRefinedStarts, starts.size()));
  if (term.form->linear && term.form->slot == Slot::kForce)
    for (auto& [squares, theta] : starts)
      ShrinkUntilFinite(hypothesis, parent.theta.size(), term.form->num_amplitudes, &theta);
  Fitted best = Fit(hypothesis, starts.front().second);
  for (std::size_t i = 1; i < starts.size(); ++i) {
    Descent other = Descend(hypothesis, starts[i].second, kMaxSteps, nullptr, &best);
    if (!other.hopeless && other.residual.squaredNorm() < best.squares) best = Finish(hypothesis, std::move(other));
  }
  return best;
}

}  // namespace armcmc::gap
