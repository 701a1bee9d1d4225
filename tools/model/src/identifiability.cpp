#include "identifiability.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "armcmc/identify/step_error.hpp"
#include "armcmc/ladder/trial.hpp"
#include "armcmc/support/text_table.hpp"

namespace armcmc::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using support::Significant;

/// What data determine about one parameter, in the coordinates that it is sampled in.
struct Identifiability {
  double sd = 0.0;                ///< Posterior standard deviation, all parameters unknown.
  double sd_alone = 0.0;          ///< The same if the others were known.
  bool informative = false;       ///< The data would identify it if the others were known.
  bool identified = false;        ///< They identify it.
  std::vector<Index> correlated;  ///< If not: parameters that compensate a change of it.
};

/// Integrated autocorrelation time of the errors, rows: 1 + 2 sum of the autocorrelations before the first that is
/// below 0.05.
double AutocorrelationTime(const VectorXd& error) {
  const Index most = error.size() / 10;
  const double power = error.squaredNorm();
  double rows = 1.0;
  for (Index lag = 1; lag < most; ++lag) {
    const double product = error.head(error.size() - lag).dot(error.tail(error.size() - lag));
    if (product <= 0.05 * power) break;
    rows += 2.0 * product / power;
  }
  return rows;
}

/// Parameters whose change compensates one of parameter d, at most three, the one with the largest share first.
std::vector<Index> CorrelatedWith(const MatrixXd& information, Index d) {
  constexpr double kMost = 3, kShare = 0.2;
  std::vector<Index> others;
  for (Index e = 0; e < information.rows(); ++e)
    if (e != d) others.push_back(e);
  if (others.empty()) return {};
  const MatrixXd block = information(others, others);
  const VectorXd move = block.ldlt().solve(VectorXd(information.col(d)(others)));
  // In units of what parameter d does itself.
  std::vector<std::pair<double, Index>> shares;
  for (std::size_t k = 0; k < others.size(); ++k) {
    const double share = std::fabs(move[static_cast<Index>(k)]) *
                         std::sqrt(block(static_cast<Index>(k), static_cast<Index>(k)) / (information(d, d) + 1e-300));
    if (share > kShare) shares.emplace_back(share, others[k]);
  }
  std::sort(shares.rbegin(), shares.rend());
  std::vector<Index> correlated;
  for (const auto& [share, e] : shares)
    if (static_cast<double>(correlated.size()) < kMost) correlated.push_back(e);
  return correlated;
}

std::vector<Identifiability> Judge(const ladder::Trial& trial, const std::vector<Index>& rows,
                                   double autocorrelation_rows) {
  constexpr double kThird = 1.0 / 3.0, kCompensated = 10.0;
  const identify::TrajectoryModel& model = *trial.model;
  const VectorXd spread = model.Spread(), prior = identify::PriorPrecision(model);
  const MatrixXd jacobian = trial.fit.jacobian(rows, Eigen::all) * spread.asDiagonal();
  const double precision = 1.0 / (trial.fit.error_sd * trial.fit.error_sd * autocorrelation_rows + 1e-300);
  const MatrixXd data = precision * jacobian.transpose() * jacobian;
  MatrixXd information = data;
  // A uniform prior says as much as one of its standard deviation would.
  information.diagonal().array() += 1.0;
  const MatrixXd covariance = information.ldlt().solve(MatrixXd::Identity(data.rows(), data.cols()));
  std::vector<Identifiability> all;
  for (Index d = 0; d < data.rows(); ++d) {
    Identifiability one;
    one.sd = std::sqrt(covariance(d, d)) * spread[d];
    one.sd_alone = spread[d] / std::sqrt(information(d, d));
    one.informative = one.sd_alone < kThird * spread[d];
    const bool compensated =
        one.sd > kCompensated * one.sd_alone &&
        one.sd > kThird * std::fabs(model.parameters()[static_cast<std::size_t>(d)].prior == "lognormal"
                                        ? 1.0
                                        : trial.fit.theta[d]);
    one.identified = one.sd < kThird * spread[d] && !compensated;
    if (one.informative && !one.identified) one.correlated = CorrelatedWith(data, d);
    all.push_back(one);
  }
  return all;
}

std::string Listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k)
    text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
  return text;
}

std::string InWords(const identify::TrajectoryModel& model, const std::vector<Identifiability>& all) {
  const auto name = [&](Index d) { return model.parameters()[static_cast<std::size_t>(d)].name; };
  std::vector<std::string> identified, uninformed;
  std::string others;
  for (std::size_t d = 0; d < all.size(); ++d) {
    if (all[d].identified) {
      identified.push_back(name(static_cast<Index>(d)));
    } else if (!all[d].informative) {
      uninformed.push_back(name(static_cast<Index>(d)));
    } else {
      std::vector<std::string> correlated;
      for (const Index e : all[d].correlated) correlated.push_back(name(e));
      others += "; not " + name(static_cast<Index>(d)) + ": " +
                (correlated.empty() ? "its effect is too small" : "it moves against " + Listed(correlated));
    }
  }
  std::string text =
      identified.empty() ? "These data identify no parameter on its own" : "These data identify " + Listed(identified);
  if (!uninformed.empty())
    text += "; not " + Listed(uninformed) + ": hardly anything in them depends on " +
            (uninformed.size() > 1 ? "these" : "it");
  return text + others + ".\n";
}

}  // namespace

std::string IdentifiabilityText(const std::shared_ptr<const Plant>& plant, const support::Recording& recording) {
  ladder::Dataset data = ladder::Compared(*plant, ladder::DatasetOf(recording));
  const ladder::Trial trial = ladder::FitAlone(plant, &data);
  if (!trial.fit.valid)
    return std::string("these data: the law has no finite value anywhere near the priors") +
           (plant->states().empty() ? "\n"
                                    : "; where states are fast, more substeps help: substeps = 10 in [states]\n");
  const identify::TrajectoryModel& model = *trial.model;
  std::vector<Index> rows;
  for (std::size_t n = 0; n < model.num_rows(); ++n)
    if (data.training[n] != 0 && model.active()[n] != 0) rows.push_back(static_cast<Index>(n));
  const VectorXd target = model.target()(rows), error = target - trial.fit.prediction(rows);
  const double autocorrelation_rows = AutocorrelationTime(error);
  const std::vector<Identifiability> all = Judge(trial, rows, autocorrelation_rows);

  support::TextTable table({"parameter", "unit", "these data", "identified", "if the others were known"},
                           support::TextTable::Content::kWords);
  for (std::size_t d = 0; d < all.size(); ++d) {
    const ParameterDescription& p = model.parameters()[d];
    const double value = model.Shown(static_cast<Index>(d), trial.fit.theta[static_cast<Index>(d)]);
    // The standard deviation of a logarithm is relative.
    const double scale = p.prior == "lognormal" ? value : 1.0;
    table.AddRow({p.name, p.unit, Significant(value, 4) + " +- " + Significant(scale * all[d].sd, 2),
                  all[d].identified ? "yes" : "no", "+- " + Significant(scale * all[d].sd_alone, 2)});
  }
  const double rms = std::sqrt(error.squaredNorm() / static_cast<double>(error.size()));
  const double size = std::sqrt((target.array() - target.mean()).square().mean());
  std::string text = std::to_string(rows.size()) + " rows used; " + plant->description().name + " leaves " +
                     Significant(rms, 3) + " (rms), " + Significant(100.0 * rms / size, 3) +
                     " % of what varies; errors are independent after " + Significant(autocorrelation_rows, 2) +
                     " rows\n\n";
  const identify::StepError steps = identify::StepErrorOf(*plant, *data.series, trial.fit.theta, rms);
  std::string warning = identify::StepErrorText(steps, data.series->dt, rms);
  if (!warning.empty()) warning = "WARNING: " + warning;
  return text + table.ToString() + '\n' + warning + InWords(model, all);
}

}  // namespace armcmc::model
