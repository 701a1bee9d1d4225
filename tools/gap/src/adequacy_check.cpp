#include "armcmc/gap/adequacy_check.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "armcmc/gap/features.hpp"
#include "armcmc/support/parallel.hpp"

namespace armcmc::gap {
namespace {

constexpr double kLineProminence = 40.0;                        // white noise of 10 000 samples reaches 20
constexpr std::array kRidges = {3e-5, 3e-4, 3e-3, 3e-2, 3e-1};  // per row, for columns of rms one
constexpr double kFreeRidge = 1e-9;                             // the hypothesis' own columns are not penalised

Matrix UnitRms(Matrix columns) {
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    const double rms = columns.col(c).norm() / std::sqrt(static_cast<double>(columns.rows()));
    columns.col(c) /= rms + 1e-300;
  }
  return columns;
}

Matrix FreeColumns(const Fitted& fitted) {
  std::vector<Eigen::Index> free;
  for (std::size_t i = 0; i < fitted.at_bound.size(); ++i)
    if (!fitted.at_bound[i]) free.push_back(static_cast<Eigen::Index>(i));
  return UnitRms(fitted.whitened_jacobian(Eigen::all, free));
}

/// Ridge with the penalty that leaves the least squared error on blocks left out.
struct Best {
  Vector squares;
  Vector coefficients;
};

Best ChooseRidge(const BlockGrams& grams, Eigen::Index num_free, double rows) {
  const Matrix total = grams.TotalGram();
  const Vector cross = grams.TotalCross();
  const auto ridge_of = [&](double strength) {
    Vector ridge = Vector::Constant(cross.size(), strength * rows);
    ridge.head(num_free).setConstant(kFreeRidge * rows);
    return ridge;
  };
  std::array<Vector, kRidges.size()> squares;
  support::InParallel(kRidges.size(),
                      [&](std::size_t i) { squares[i] = LeaveBlockOut(grams, total, cross, ridge_of(kRidges[i])); });
  // Of sums that are not numbers none is the least.
  std::size_t best = kRidges.size();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kRidges.size(); ++i) {
    if (!(squares[i].sum() < least)) continue;
    least = squares[i].sum();
    best = i;
  }
  if (best == kRidges.size()) return {};
  Matrix penalised = total;
  penalised.diagonal() += ridge_of(kRidges[best]);
  return {squares[best], penalised.ldlt().solve(cross)};
}

}  // namespace

AdequacyCheck::AdequacyCheck(const Fitter& fitter, const Vector& predicted)
    : fitter_(&fitter), groups_(fitter.equation().Groups(fitter.signals(), predicted)) {
  Eigen::Index count = 0;
  for (const FeatureGroup& group : groups_) count += group.columns.cols();
  Matrix all(fitter.signals().rows(), count);
  Eigen::Index at = 0;
  for (const FeatureGroup& group : groups_) {
    all.middleCols(at, group.columns.cols()) = group.columns;
    at += group.columns.cols();
  }
  columns_ = UnitRms(fitter.whitener().Apply(all));
  grams_ = MakeGrams(columns_, Vector::Zero(columns_.rows()));
}

Vector AdequacyCheck::GainOfAll(const Fitted& fitted, const Matrix& extra, Vector* unexplained) const {
  const Matrix free = FreeColumns(fitted);
  const Eigen::Index f = free.cols(), e = extra.cols(), p = columns_.cols();
  Matrix own(free.rows(), f + e);
  own << free, extra;
  const BlockGrams small = MakeGrams(own, fitted.whitened_residual);
  const auto edges = BlockEdges(free.rows());
  BlockGrams grams;
  grams.squares = small.squares;
  for (std::size_t b = 0; b < kNumBlocks; ++b) {
    const Eigen::Index first = edges[b], rows = edges[b + 1] - edges[b];
    const auto block = columns_.middleRows(first, rows);
    Matrix gram(f + e + p, f + e + p);
    gram.topLeftCorner(f + e, f + e) = small.gram[b];
    gram.bottomRightCorner(p, p) = grams_.gram[b];
    if (own.cols() > 0) {
      gram.bottomLeftCorner(p, f + e).noalias() = block.transpose() * own.middleRows(first, rows);
      gram.topRightCorner(f + e, p) = gram.bottomLeftCorner(p, f + e).transpose();
    }
    Vector cross(f + e + p);
    cross << small.cross[b], block.transpose() * fitted.whitened_residual.segment(first, rows);
    grams.gram.push_back(std::move(gram));
    grams.cross.push_back(std::move(cross));
  }
  const Best best = ChooseRidge(grams, f, static_cast<double>(free.rows()));
  if (unexplained != nullptr)
    *unexplained =
        fitted.whitened_residual - own * best.coefficients.head(f + e) - columns_ * best.coefficients.tail(p);
  return -0.5 / fitter_->whitener().variance * best.squares - fitted.heldout;
}

Remainder AdequacyCheck::Judge(const Fitted& fitted) const {
  const Signals& signals = fitter_->signals();
  Remainder remainder;
  const Line line = StrongestLine(fitted.whitened_residual, signals.dt);
  Matrix extra(signals.rows(), 0);
  if (line.prominence > kLineProminence) {
    remainder.line_frequency = line.frequency;
    extra = UnitRms(fitter_->whitener().Apply(Waves(signals.t, line.frequency, 1, 1)));
  }
  remainder.gain = GainOfAll(fitted, extra, &remainder.unexplained);
  return remainder;
}

Vector AdequacyCheck::GainOfAll(const Fitted& fitted, const Matrix& extra) const {
  return GainOfAll(fitted, UnitRms(extra), nullptr);
}

Vector AdequacyCheck::GainOf(const Fitted& fitted, const std::vector<std::string>& groups, const Matrix& extra) const {
  std::vector<Eigen::Index> chosen;
  Eigen::Index at = 0;
  for (const FeatureGroup& group : groups_) {
    if (std::find(groups.begin(), groups.end(), group.name) != groups.end())
      for (Eigen::Index c = 0; c < group.columns.cols(); ++c) chosen.push_back(at + c);
    at += group.columns.cols();
  }
  const Matrix free = FreeColumns(fitted);
  Matrix columns(free.rows(), free.cols() + extra.cols() + static_cast<Eigen::Index>(chosen.size()));
  columns << free, UnitRms(fitter_->whitener().Apply(extra)), columns_(Eigen::all, chosen);
  const Best best =
      ChooseRidge(MakeGrams(columns, fitted.whitened_residual), free.cols(), static_cast<double>(free.rows()));
  return -0.5 / fitter_->whitener().variance * best.squares - fitted.heldout;
}

}  // namespace armcmc::gap
