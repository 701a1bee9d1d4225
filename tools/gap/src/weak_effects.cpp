// Probability that an effect is present which is too weak to be named.

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "armcmc/gap/blocks.hpp"
#include "armcmc/gap/search.hpp"

namespace armcmc::gap {
namespace {

/// Whitened columns of an effect's amplitudes, orthogonal to the coordinates before them.
Matrix AmplitudeColumns(const Fitted& fit, const EffectForm& form) {
  const Eigen::Index first = fit.theta.size() - form.size();
  const Matrix basis = OrthonormalBasis(fit.whitened_jacobian.leftCols(first));
  const Matrix columns = fit.whitened_jacobian.middleCols(first, form.num_amplitudes);
  return columns - basis * (basis.transpose() * columns);
}

double LogSumExp(const Vector& terms) {
  const double top = terms.maxCoeff();
  return top + std::log((terms.array() - top).exp().sum());
}

/// ln of  1/L int exp(z rho - rho^2 / 2) d ln R,  rho = R per_ratio: the likelihood ratio of an effect that shows with
/// z standard deviations, over its absence, with ln R uniform. Where two amplitudes make up the effect (a wave) the
/// likelihood is averaged over its phase.
double LogScaleFree(double z, double per_ratio, bool phase, double least, double most) {
  constexpr int kPoints = 400;
  Vector terms(kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const double rho = per_ratio * least * std::pow(most / least, (i + 0.5) / kPoints);
    terms[i] = z * rho - 0.5 * rho * rho - (phase ? 0.5 * std::log1p(2.0 * std::numbers::pi * z * rho) : 0.0);
  }
  return LogSumExp(terms) - std::log(kPoints);
}

/// Scatter of the correlation of a residual with columns from block to block, relative to that of white noise: more
/// where the noise is stronger where the columns act, or not quite white. So many columns would take that for evidence.
double Dispersion(const Matrix& columns, const Vector& residual, double variance) {
  const BlockGrams grams = MakeGrams(columns, residual);
  double scatter = 0.0, expected = 1e-300;
  for (std::size_t b = 0; b < grams.cross.size(); ++b) {
    scatter += grams.cross[b].squaredNorm();
    expected += variance * grams.gram[b].trace();
  }
  return scatter / expected;
}

}  // namespace

double Search::LogOdds(const CandidatePtr& candidate) const {
  const Fitted& fit = candidate->fit;
  const EffectForm& form = *fit.hypothesis.terms.back().form;
  const double evidence = fit.log_evidence - base_->fit.log_evidence;
  if (!form.linear || form.num_amplitudes == 0) return evidence;
  const double variance = fitter_->whitener().variance;
  const Matrix columns = AmplitudeColumns(fit, form);
  const Vector strengths = columns.colwise().squaredNorm();
  if (!(strengths.minCoeff() > 0.0)) return evidence;
  // Without the prior of the amplitudes, the likelihood at the best amplitudes remains.
  Matrix information = columns.transpose() * columns / variance;
  const Eigen::Index first = fit.theta.size() - form.size();
  double likelihood = evidence;
  for (Eigen::Index a = 0; a < form.num_amplitudes; ++a) {
    const Coordinate& c = form.coordinates[static_cast<std::size_t>(a)];
    likelihood += std::log(c.prior_sd) + 0.5 * std::pow((fit.theta[first + a] - c.prior_mean) / c.prior_sd, 2);
    information(a, a) += std::pow(c.prior_sd, -2);
  }
  likelihood += 0.5 * information.ldlt().vectorD().cwiseMax(1e-300).array().log().sum();
  const Vector column = columns.col(0);
  const double noise = std::sqrt(variance * fitter_->whitener().Gain());
  const double per_ratio =
      column.norm() / std::sqrt(variance) * noise * std::sqrt(rows_) / fitter_->whitener().Colour(column).norm();
  return LogScaleFree(std::sqrt(2.0 * std::max(likelihood, 0.0)), per_ratio, form.num_amplitudes > 1,
                      limits_.tie_effect, limits_.largest_ratio);
}

double Search::LogOddsOfLawError(const CandidatePtr& law) const {
  constexpr int kPoints = 100;
  const EffectForm& form = *law->fit.hypothesis.terms.back().form;
  const Whitener& whitener = fitter_->whitener();
  const Matrix columns = AmplitudeColumns(law->fit, form);
  const Vector& residual = base_->fit.whitened_residual;
  const double variance = whitener.variance * std::max(1.0, Dispersion(columns, residual, whitener.variance));
  const Eigen::SelfAdjointEigenSolver<Matrix> axes(columns.transpose() * columns / variance);
  const Eigen::ArrayXd size = axes.eigenvalues().cwiseMax(0.0);
  const Eigen::ArrayXd shown =
      (axes.eigenvectors().transpose() * (columns.transpose() * residual) / variance).array().square();
  double change = 0.0;  // of the prediction, by shares of standard deviation one
  for (Eigen::Index c = 0; c < columns.cols(); ++c) change += whitener.Colour(Vector(columns.col(c))).squaredNorm();
  const double per_ratio = std::sqrt(rows_ * whitener.variance * whitener.Gain() / std::max(change, 1e-300));
  Vector terms(kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const double share =
        per_ratio * limits_.tie_effect * std::pow(limits_.largest_ratio / limits_.tie_effect, (i + 0.5) / kPoints);
    const Eigen::ArrayXd gained = share * share / (1.0 + share * share * size);
    terms[i] = 0.5 * (shown * gained - (1.0 + share * share * size).log()).sum();
  }
  return LogSumExp(terms) - std::log(kPoints);
}

void Search::AllowForLawError(Finding* finding) const {
  const CandidatePtr law = LawError();
  if (!law) return;
  std::set<std::string> families;
  for (const CandidatePtr& candidate : finding->tried)
    if (candidate->probability > 0.0) families.insert(candidate->families().front());
  if (families.empty()) return;
  const double odds =
      LogOddsOfLawError(law) + std::log(finding->p_none) - std::log(static_cast<double>(families.size()));
  law->probability = 1.0 / (1.0 + std::exp(-odds));
  const double others = 1.0 / (1.0 + std::exp(odds));
  finding->p_none *= others;
  for (const CandidatePtr& candidate : finding->tried) candidate->probability *= others;
  finding->tried.push_back(law);
}

double Search::Ratio(const CandidatePtr& candidate) const {
  const Whitener& whitener = fitter_->whitener();
  return (candidate->fit.predicted - base_->fit.predicted).norm() /
         std::sqrt(rows_ * whitener.variance * whitener.Gain());
}

double Search::ProbabilityOfNone(const Candidates& singles) const {
  // Each family counts once, whatever its number of members.
  std::map<std::string, std::vector<std::pair<CandidatePtr, double>>> families;
  for (const CandidatePtr& single : singles)
    if (single->exact() && single->added().back().when.kind == When::Kind::kAlways)
      families[single->families().front()].emplace_back(single, LogOdds(single));
  if (families.empty()) return 1.0;
  const auto weight = [&](std::size_t members) {
    return -std::log(static_cast<double>(members) * static_cast<double>(families.size()));
  };
  std::vector<double> logs{0.0};  // no effect, with the prior probability of all effects together
  for (const auto& [family, members] : families)
    for (const auto& member : members) logs.push_back(member.second + weight(members.size()));
  const double total = LogSumExp(Eigen::Map<const Vector>(logs.data(), static_cast<Eigen::Index>(logs.size())));
  for (const auto& [family, members] : families)
    for (const auto& [single, odds] : members) single->probability = std::exp(odds + weight(members.size()) - total);
  return std::exp(-total);
}

}  // namespace armcmc::gap
