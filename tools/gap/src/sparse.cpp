#include "sparse.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "armcmc/gap/blocks.hpp"
#include "armcmc/gap/features.hpp"

namespace armcmc::gap {
namespace {

constexpr std::size_t kMaxTerms = 4;
constexpr double kMinShare = 0.05;     // of the gap, that a term must close on blocks left out
constexpr double kSure = 0.999;        // of the bootstrap, that it closes anything: one of a hundred terms is chosen
constexpr double kGatePenalty = 0.97;  // of its gain: a term that acts always is the shorter description
constexpr double kRidge = 1e-9;        // per row, for columns of rms one

struct SimpleTerm {
  std::string text;
  Vector value;
};

/// Each symbol by itself: "v", "v^2", "v^3", "|v|", "v |v|", "sign(v)".
void AddPowers(const PlotFeature& of, std::vector<SimpleTerm>* terms) {
  const std::string& s = of.symbol;
  const Eigen::ArrayXd x = of.value.array();
  terms->push_back({s, x});
  terms->push_back({s + "^2", x.square()});
  terms->push_back({s + "^3", x.cube()});
  terms->push_back({"|" + s + "|", x.abs()});
  terms->push_back({s + " |" + s + "|", x * x.abs()});
  terms->push_back({"sign(" + s + ")", x.sign()});
}

/// One symbol times another: "x v", "x^2 v", "x |v|", "x sign(v)".
void AddProducts(const PlotFeature& a, const PlotFeature& b, bool first, std::vector<SimpleTerm>* terms) {
  const Eigen::ArrayXd x = a.value.array(), y = b.value.array();
  if (first) terms->push_back({a.symbol + " " + b.symbol, x * y});
  terms->push_back({a.symbol + "^2 " + b.symbol, x.square() * y});
  terms->push_back({a.symbol + " |" + b.symbol + "|", x * y.abs()});
  terms->push_back({a.symbol + " sign(" + b.symbol + ")", x * y.sign()});
}

/// The terms that may be chosen; those that act in one mode only behind those that act always.
std::vector<SimpleTerm> Library(const Equation& equation, const Analysis& analysis, std::size_t* num_always) {
  std::vector<PlotFeature> variables = equation.PlotFeatures(analysis.signals);
  variables.push_back({"", analysis.finding.base->fit.predicted, equation.output_name() + "_model"});
  std::vector<SimpleTerm> terms = {{"1", Vector::Ones(analysis.signals.rows())}};
  for (std::size_t i = 0; i < variables.size(); ++i) {
    AddPowers(variables[i], &terms);
    for (std::size_t j = 0; j < variables.size(); ++j)
      if (j != i) AddProducts(variables[i], variables[j], i < j, &terms);
  }
  *num_always = terms.size();
  for (std::size_t i = 0; i < *num_always; ++i) {
    terms.push_back(
        {terms[i].text + " [" + equation.active_name() + "]", terms[i].value.cwiseProduct(analysis.signals.active)});
    terms.push_back({terms[i].text + " [" + equation.passive_name() + "]",
                     (terms[i].value.array() * (1.0 - analysis.signals.active.array())).matrix()});
  }
  return terms;
}

/// Whitened columns of rms one: those of the base parameters, then the library.
struct Columns {
  BlockGrams grams;
  Vector rms;  ///< Before scaling.
  Eigen::Index num_base = 0;
};

Columns Whiten(const Analysis& analysis, const std::vector<SimpleTerm>& terms) {
  const Fitted& base = analysis.finding.base->fit;
  std::vector<Eigen::Index> free;
  for (std::size_t i = 0; i < base.at_bound.size(); ++i)
    if (!base.at_bound[i]) free.push_back(static_cast<Eigen::Index>(i));
  Matrix library(analysis.signals.rows(), static_cast<Eigen::Index>(terms.size()));
  for (std::size_t k = 0; k < terms.size(); ++k) library.col(static_cast<Eigen::Index>(k)) = terms[k].value;
  Matrix all = JoinColumns(base.whitened_jacobian(Eigen::all, free), analysis.fitter->whitener().Apply(library));
  Columns columns;
  columns.num_base = static_cast<Eigen::Index>(free.size());
  columns.rms = (all.colwise().norm() / std::sqrt(static_cast<double>(all.rows()))).transpose();
  for (Eigen::Index c = 0; c < all.cols(); ++c) all.col(c) /= columns.rms[c] + 1e-300;
  columns.grams = MakeGrams(all, base.whitened_residual);
  return columns;
}

}  // namespace

std::vector<SparseTerm> DescribeSparsely(const Equation& equation, const Diagnosis& diagnosis) {
  const Analysis& analysis = *diagnosis.wide;
  std::size_t num_always = 0;
  const std::vector<SimpleTerm> terms = Library(equation, analysis, &num_always);
  const Columns columns = Whiten(analysis, terms);
  const auto rows = static_cast<double>(analysis.signals.rows());
  const double variance = analysis.fitter->whitener().variance;
  const auto ridge_of = [rows](std::size_t n) -> Vector {
    return Vector::Constant(static_cast<Eigen::Index>(n), kRidge * rows);
  };
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index c = 0; c < columns.num_base; ++c) chosen.push_back(c);
  Vector squares = LeaveBlockOut(columns.grams.Only(chosen), ridge_of(chosen.size()));
  std::vector<SparseTerm> found;
  while (found.size() < kMaxTerms) {
    Vector best_squares;
    std::size_t best = 0;
    double most = 0.0;
    for (std::size_t k = 0; k < terms.size(); ++k) {
      const Eigen::Index column = columns.num_base + static_cast<Eigen::Index>(k);
      if (!(columns.rms[column] > 0.0) || std::find(chosen.begin(), chosen.end(), column) != chosen.end()) continue;
      std::vector<Eigen::Index> with = chosen;
      with.push_back(column);
      Vector left = LeaveBlockOut(columns.grams.Only(with), ridge_of(with.size()));
      const double gain = (squares - left).sum() * (k < num_always ? 1.0 : kGatePenalty);
      if (!(gain > most)) continue;
      most = gain;
      best = k;
      best_squares = std::move(left);
    }
    if (!(most > 0.0)) break;
    const Vector gain = 0.5 / variance * (squares - best_squares);
    const double share = 2.0 * gain.sum() / rows / std::max(diagnosis.finding.gap, 1e-12);
    if (share < kMinShare || diagnosis.bootstrap->ProbabilityAbove(gain, 0.0) < kSure) break;
    found.push_back({terms[best].text, 0.0, std::min(share, 1.0)});
    chosen.push_back(columns.num_base + static_cast<Eigen::Index>(best));
    squares = best_squares;
  }
  if (found.empty()) return found;
  const BlockGrams grams = columns.grams.Only(chosen);
  Matrix total = grams.TotalGram();
  total.diagonal() += ridge_of(chosen.size());
  const Vector coefficients = total.ldlt().solve(grams.TotalCross());
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Eigen::Index at = columns.num_base + static_cast<Eigen::Index>(k);
    found[k].coefficient = coefficients[at] / columns.rms[chosen[static_cast<std::size_t>(at)]];
  }
  return found;
}

}  // namespace armcmc::gap
