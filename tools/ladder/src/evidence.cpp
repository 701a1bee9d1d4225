#include "armcmc/ladder/evidence.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace armcmc::ladder {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

struct Term {
  std::string expression;
  VectorXd value;  ///< [examined row]
};

std::vector<Term> Library(const std::vector<Feature>& features, const std::vector<Index>& rows) {
  std::vector<Term> terms{{"1", VectorXd::Ones(static_cast<Index>(rows.size()))}};
  for (const Feature& feature : features) {
    const VectorXd x = feature.value(rows);
    const std::string& n = feature.name;
    terms.push_back({n, x});
    terms.push_back({"abs(" + n + ")", x.cwiseAbs()});
    terms.push_back({"sign(" + n + ")", x.cwiseSign()});
    terms.push_back({std::string(n).append("*abs(").append(n).append(")"), x.cwiseProduct(x.cwiseAbs())});
    terms.push_back({n + "^2", x.cwiseAbs2()});
    terms.push_back({n + "^3", x.cwiseProduct(x.cwiseAbs2())});
  }
  for (std::size_t i = 0; i < features.size(); ++i)
    for (std::size_t j = i + 1; j < features.size(); ++j)
      terms.push_back({features[i].name + "*" + features[j].name,
                       VectorXd(features[i].value(rows).cwiseProduct(features[j].value(rows)))});
  return terms;
}

/// Rows of every other one of twenty segments.
std::vector<Index> Half(Index size, Index which) {
  constexpr Index kStretches = 20;
  std::vector<Index> half;
  for (Index k = 0; k < size; ++k)
    if ((k * kStretches / size) % 2 == which) half.push_back(k);
  return half;
}

/// Squared error of each half, with the sum fitted to the other half.
double CrossSquare(const Eigen::MatrixXd& columns, const VectorXd& error) {
  double square = 0.0;
  for (const Index which : {Index{0}, Index{1}}) {
    const std::vector<Index> fitted = Half(error.size(), which), judged = Half(error.size(), 1 - which);
    const Eigen::MatrixXd a = columns(fitted, Eigen::all);
    Eigen::MatrixXd normal = a.transpose() * a;
    normal.diagonal() *= 1.0 + 1e-9;
    const VectorXd weight = normal.ldlt().solve(a.transpose() * error(fitted));
    square += (error(judged) - columns(judged, Eigen::all) * weight).squaredNorm();
  }
  return square;
}

Eigen::MatrixXd With(const Eigen::MatrixXd& columns, const VectorXd& more) {
  Eigen::MatrixXd joined(more.size(), columns.cols() + 1);
  if (columns.cols() > 0) joined.leftCols(columns.cols()) = columns;
  joined.rightCols(1) = more;
  return joined;
}

}  // namespace

std::vector<gap::Where> WhereErrorsAre(const VectorXd& error, const std::vector<Feature>& features,
                                       const std::vector<Index>& rows, double floor) {
  constexpr double kPart = 0.1;
  std::vector<gap::Where> out;
  const double noise = floor * floor;
  const auto size = static_cast<double>(rows.size());
  const double excess = std::max(error(rows).squaredNorm() - noise * size, 1e-300);
  const auto part = static_cast<std::size_t>(std::ceil(kPart * size));
  for (const Feature& feature : features) {
    gap::Where best{feature.name, "", 0.0, 0.0, std::numeric_limits<double>::quiet_NaN()};
    const auto look = [&](const std::string& region, auto key) {
      std::vector<Index> order = rows;
      std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(part) - 1, order.end(),
                       [&](Index a, Index b) { return key(feature.value[a]) < key(feature.value[b]); });
      order.resize(part);
      const double square = error(order).squaredNorm() - noise * static_cast<double>(part);
      if (square / excess > best.share_of_excess)
        best = {feature.name, region, std::min(square / excess, 1.0),
                square / static_cast<double>(part) / std::max(noise, 1e-300), best.p_value};
    };
    look("lowest tenth of " + feature.name, [](double x) { return x; });
    look("highest tenth of " + feature.name, [](double x) { return -x; });
    look(feature.name + " next to 0", [](double x) { return std::fabs(x); });
    if (best.share_of_excess > 1.5 * kPart) out.push_back(best);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const gap::Where& a, const gap::Where& b) { return a.share_of_excess > b.share_of_excess; });
  return out;
}

std::vector<gap::SparseTerm> SparseSum(const VectorXd& error, const std::vector<Feature>& features,
                                       const std::vector<Index>& rows) {
  constexpr std::size_t kMost = 3;
  constexpr double kWorth = 0.02;
  if (rows.size() < 100) return {};
  const std::vector<Term> library = Library(features, rows);
  const VectorXd y = error(rows);
  const double all = y.squaredNorm() + 1e-300;
  double left = all;
  Eigen::MatrixXd columns(y.size(), 0);
  std::vector<gap::SparseTerm> sum;
  while (sum.size() < kMost) {
    double least = left;
    const Term* best = nullptr;
    for (const Term& term : library) {
      if (!(term.value.squaredNorm() > 0.0)) continue;
      const double square = CrossSquare(With(columns, term.value), y);
      if (square < least) {
        least = square;
        best = &term;
      }
    }
    if (best == nullptr || left - least < kWorth * all) break;
    columns = With(columns, best->value);
    sum.push_back({best->expression, 0.0, (left - least) / all});
    left = least;
  }
  if (sum.empty()) return sum;
  Eigen::MatrixXd normal = columns.transpose() * columns;
  normal.diagonal() *= 1.0 + 1e-9;
  const VectorXd weight = normal.ldlt().solve(columns.transpose() * y);
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i].coefficient = weight[static_cast<Index>(i)];
  return sum;
}

}  // namespace armcmc::ladder
