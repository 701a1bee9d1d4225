// Fits that leave one group of rows out at a time.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "armcmc/identify/fit.hpp"
#include "fit_problem.hpp"
#include "forward_differences.hpp"
#include "levenberg_marquardt.hpp"
#include "shared_runs.hpp"

namespace armcmc::identify {
namespace {

/// Jacobian at some rows in units of the spread, by forward differences.
class JacobianAt : public PredictionUser {
 public:
  JacobianAt(const FitProblem& problem, const Eigen::VectorXd& theta, const std::vector<Eigen::Index>& rows)
      : problem_(problem), theta_(theta), rows_(rows) {}

  [[nodiscard]] Eigen::MatrixXd Request() override {
    thetas_ = Displaced(problem_, theta_);
    return thetas_;
  }
  void Receive(const Eigen::Ref<const Eigen::MatrixXd>& predictions) override {
    jacobian_ = ForwardJacobian(problem_, thetas_, predictions, rows_);
    done_ = true;
  }
  /// Empty if it is not finite.
  [[nodiscard]] const Eigen::MatrixXd& jacobian() const { return jacobian_; }

 private:
  const FitProblem& problem_;
  const Eigen::VectorXd theta_;
  const std::vector<Eigen::Index>& rows_;
  Eigen::MatrixXd thetas_, jacobian_;
};

}  // namespace

FitsWithout FitWithoutEach(const TrajectoryModel& model, const FitResult& all, const std::vector<Eigen::Index>& rows,
                           const std::vector<std::vector<Eigen::Index>>& groups, int max_iterations) {
  constexpr int kSameJacobian = 2;
  constexpr double kMoves = 0.1;  // of the cost
  const std::vector<double> undamped{0.0}, damped{1e-2, 1.0, 100.0};
  FitProblem problem = MakeFitProblem(model, std::vector<std::uint8_t>(model.num_rows(), 0));
  problem.rows = rows;
  const auto num_groups = static_cast<Eigen::Index>(groups.size());
  Eigen::MatrixXd jacobian = all.jacobian(rows, Eigen::all);
  jacobian *= problem.spread.asDiagonal();
  const Eigen::MatrixXd gram = jacobian.transpose() * jacobian;
  const Eigen::VectorXd error = (model.target() - all.prediction)(rows);

  FitsWithout fits{all.theta.replicate(1, num_groups), error.replicate(1, num_groups),
                   std::vector<Eigen::MatrixXd>(groups.size(), all.jacobian(rows, Eigen::all))};
  std::vector<Eigen::MatrixXd> part, gram_without;
  std::vector<Eigen::Index> moving;
  const auto squares_without = [&](const Eigen::VectorXd& e, Eigen::Index g) {
    return std::max(e.squaredNorm() - e(groups[static_cast<std::size_t>(g)]).squaredNorm(), 0.0);
  };
  const auto count_without = [&](Eigen::Index g) {
    return static_cast<Eigen::Index>(rows.size() - groups[static_cast<std::size_t>(g)].size());
  };
  const auto cost = [&](const Eigen::VectorXd& e, const Eigen::VectorXd& theta, Eigen::Index g) {
    const auto count = static_cast<double>(count_without(g));
    return 0.5 * count * std::log(squares_without(e, g) / count + 1e-300) +
           0.5 * (theta - problem.mean).cwiseAbs2().dot(problem.precision);
  };
  for (Eigen::Index g = 0; g < num_groups; ++g) {
    part.emplace_back(jacobian(groups[static_cast<std::size_t>(g)], Eigen::all));
    gram_without.emplace_back(gram - part.back().transpose() * part.back());
    if (count_without(g) > 0) moving.push_back(g);
  }
  // Steps of these groups with these dampings. Returns the places of the groups that none of them improves.
  const auto step = [&](const std::vector<Eigen::Index>& of, const std::vector<NormalSystem>& normals,
                        const std::vector<double>& dampings) {
    const auto trials = static_cast<Eigen::Index>(dampings.size());
    Eigen::MatrixXd thetas(all.theta.size(), static_cast<Eigen::Index>(of.size()) * trials), predictions;
    for (std::size_t k = 0; k < of.size(); ++k)
      thetas.middleCols(static_cast<Eigen::Index>(k) * trials, trials) =
          Steps(problem, fits.theta.col(of[k]), normals[k], dampings);
    model.Predict(thetas, &predictions, &rows);
    std::vector<std::size_t> worse;
    for (std::size_t k = 0; k < of.size(); ++k) {
      const Eigen::Index g = of[k];
      const double before = cost(fits.error.col(g), fits.theta.col(g), g);
      double best = before;
      for (Eigen::Index c = static_cast<Eigen::Index>(k) * trials; c < static_cast<Eigen::Index>(k + 1) * trials; ++c) {
        if (!thetas.col(c).allFinite() || !std::isfinite(predictions(0, c))) continue;
        const Eigen::VectorXd e = (model.target() - predictions.col(c))(rows);
        const double its = cost(e, thetas.col(c), g);
        if (!(its < best)) continue;
        best = its;
        fits.theta.col(g) = thetas.col(c);
        fits.error.col(g) = e;
      }
      if (!(best < before)) worse.push_back(k);
    }
    return worse;
  };
  // First steps with the Jacobian of the fit to all rows; the last one, with the Jacobian of each fit, shows whether it
  // has converged.
  for (int iteration = 0; iteration <= kSameJacobian && !moving.empty(); ++iteration) {
    std::vector<std::unique_ptr<JacobianAt>> own;
    for (std::size_t k = 0; k < moving.size() && iteration == kSameJacobian; ++k)
      own.push_back(std::make_unique<JacobianAt>(problem, fits.theta.col(moving[k]), rows));
    RunAll(model, &rows, own);
    std::vector<NormalSystem> normals;
    std::vector<double> before;
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const Eigen::Index g = moving[k];
      const std::vector<Eigen::Index>& group = groups[static_cast<std::size_t>(g)];
      const Eigen::VectorXd e = fits.error.col(g), theta = fits.theta.col(g);
      NormalSystem normal;
      if (!own.empty() && own[k]->jacobian().size() > 0) {
        const Eigen::MatrixXd& its = own[k]->jacobian();
        fits.jacobian[static_cast<std::size_t>(g)] = its * problem.spread.cwiseInverse().asDiagonal();
        const Eigen::MatrixXd without = its(group, Eigen::all);
        normal = {its.transpose() * its - without.transpose() * without,
                  its.transpose() * e - without.transpose() * e(group)};
      } else {
        normal = {gram_without[static_cast<std::size_t>(g)],
                  jacobian.transpose() * e - part[static_cast<std::size_t>(g)].transpose() * e(group)};
      }
      AddPrior(problem, theta, squares_without(e, g), count_without(g), &normal);
      normals.push_back(std::move(normal));
      before.push_back(cost(e, theta, g));
    }
    // What a whole step does not improve, a damped one may.
    std::vector<Eigen::Index> left;
    std::vector<NormalSystem> of_left;
    for (const std::size_t k : step(moving, normals, undamped)) {
      left.push_back(moving[k]);
      of_left.push_back(normals[k]);
    }
    if (!left.empty()) static_cast<void>(step(left, of_left, damped));
    std::vector<Eigen::Index> still;
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const Eigen::Index g = moving[k];
      if (iteration < kSameJacobian || before[k] - cost(fits.error.col(g), fits.theta.col(g), g) > kMoves)
        still.push_back(g);
    }
    moving = std::move(still);
  }
  // Those that have not are fitted by themselves.
  std::vector<FitProblem> problems(moving.size(), problem);
  std::vector<std::unique_ptr<LevenbergMarquardt>> fitting;
  for (std::size_t m = 0; m < moving.size(); ++m) {
    const Eigen::Index g = moving[m];
    std::vector<std::uint8_t> in_group(rows.size(), 0);
    for (const Eigen::Index k : groups[static_cast<std::size_t>(g)]) in_group[static_cast<std::size_t>(k)] = 1;
    problems[m].rows.clear();
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (in_group[k] == 0) problems[m].rows.push_back(rows[k]);
    fitting.push_back(std::make_unique<LevenbergMarquardt>(problems[m], fits.theta.col(g), max_iterations, kMoves,
                                                           Differences::kCentral));
  }
  RunAll(model, &rows, fitting);
  std::vector<std::unique_ptr<JacobianAt>> there;
  for (std::size_t m = 0; m < moving.size(); ++m)
    there.push_back(std::make_unique<JacobianAt>(problem, fitting[m]->result().theta, rows));
  RunAll(model, &rows, there);
  for (std::size_t m = 0; m < moving.size(); ++m) {
    const FitResult& fit = fitting[m]->result();
    if (!fit.valid || there[m]->jacobian().size() == 0) continue;
    fits.theta.col(moving[m]) = fit.theta;
    fits.error.col(moving[m]) = (model.target() - fit.prediction)(rows);
    fits.jacobian[static_cast<std::size_t>(moving[m])] =
        there[m]->jacobian() * problem.spread.cwiseInverse().asDiagonal();
  }
  return fits;
}

}  // namespace armcmc::identify
