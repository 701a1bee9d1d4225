#include "armcmc/identify/fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "fit_problem.hpp"
#include "forward_differences.hpp"
#include "levenberg_marquardt.hpp"
#include "shared_runs.hpp"

namespace armcmc::identify {
namespace {

/// Of the cost, for a fit to go on.
double LeastGain(const FitProblem& problem) { return 1e-3 + 1e-7 * static_cast<double>(problem.rows.size()); }

/// The same for a fit that another one continues: what gains a thousandth of the mean square and less in an iteration
/// is found there.
double LeastGainOfFirst(const FitProblem& problem) {
  return LeastGain(problem) + 0.5e-3 * static_cast<double>(problem.rows.size());
}

/// Moves a start along one parameter at a time, the one that lowers the cost most, see BestFit().
class CoordinateSearch : public PredictionUser {
 public:
  CoordinateSearch(const FitProblem& problem, const Eigen::VectorXd& start, int steps)
      : problem_(problem), steps_(steps), theta_(start.cwiseMax(problem.lower).cwiseMin(problem.upper)) {
    done_ = steps == 0 || problem.rows.empty();
  }

  [[nodiscard]] Eigen::MatrixXd Request() override {
    if (linearises_) thetas_ = Displaced(problem_, theta_);
    return thetas_;
  }
  void Receive(const Eigen::Ref<const Eigen::MatrixXd>& predictions) override {
    if (linearises_) {
      ReceiveLinearised(predictions);
      return;
    }
    Eigen::Index best = theta_.size();
    for (Eigen::Index d = 0; d < theta_.size(); ++d)
      if (std::isfinite(predictions(0, d)) &&
          problem_.Cost(thetas_.col(d), predictions.col(d)) < problem_.Cost(thetas_.col(best), predictions.col(best)))
        best = d;
    theta_ = thetas_.col(best);
    linearises_ = true;
    done_ = --steps_ == 0;
  }
  [[nodiscard]] const Eigen::VectorXd& theta() const { return theta_; }

 private:
  void ReceiveLinearised(const Eigen::Ref<const Eigen::MatrixXd>& predictions) {
    const Eigen::MatrixXd jacobian = ForwardJacobian(problem_, thetas_, predictions, problem_.rows);
    if (jacobian.size() == 0) {
      done_ = true;
      return;
    }
    const Eigen::VectorXd error = (problem_.model.target() - predictions.col(theta_.size()))(problem_.rows);
    thetas_ = theta_.replicate(1, theta_.size() + 1);
    for (Eigen::Index d = 0; d < theta_.size(); ++d) {
      const auto along = jacobian.col(d);
      const double move = problem_.spread[d] * along.dot(error) / (along.squaredNorm() + 1e-300);
      thetas_(d, d) = std::clamp(theta_[d] + move, problem_.lower[d], problem_.upper[d]);
    }
    linearises_ = false;
  }

  const FitProblem& problem_;
  int steps_;
  Eigen::VectorXd theta_;
  Eigen::MatrixXd thetas_;
  bool linearises_ = true;
};

/// The fit with its Jacobian, by central differences; invalid where it has none.
FitResult Complete(const TrajectoryModel& model, FitResult fit) {
  fit.valid = fit.valid && model.Linearise(fit.theta, &fit.prediction, &fit.jacobian);
  return fit;
}

}  // namespace

Eigen::VectorXd PriorPrecision(const TrajectoryModel& model) {
  Eigen::VectorXd precision(model.num_parameters());
  for (Eigen::Index d = 0; d < precision.size(); ++d) {
    const ParameterDescription& p = model.parameters()[static_cast<std::size_t>(d)];
    precision[d] = p.prior == "uniform" ? 0.0 : 1.0 / (p.sd * p.sd);
  }
  return precision;
}

FitResult Fit(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows, const Eigen::VectorXd& start,
              int max_iterations) {
  const FitProblem problem = MakeFitProblem(model, rows);
  LevenbergMarquardt fitting(problem, start, max_iterations, LeastGain(problem), Differences::kCentral);
  RunTogether(model, nullptr, {&fitting});
  return Complete(model, std::move(fitting.result()));
}

FitResult BestFit(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows,
                  const std::vector<Eigen::VectorXd>& starts, std::size_t most_fits, int max_iterations,
                  bool along_one) {
  constexpr int kAlong = 3, kFirst = 2;
  const FitProblem problem = MakeFitProblem(model, rows);
  std::vector<std::unique_ptr<CoordinateSearch>> moved;
  moved.reserve(starts.size());
  for (const Eigen::VectorXd& start : starts)
    moved.push_back(std::make_unique<CoordinateSearch>(problem, start, along_one ? kAlong : 0));
  RunAll(model, nullptr, moved);
  std::vector<std::unique_ptr<LevenbergMarquardt>> fits;
  fits.reserve(moved.size());
  for (const std::unique_ptr<CoordinateSearch>& start : moved)
    fits.push_back(std::make_unique<LevenbergMarquardt>(problem, start->theta(), kFirst, LeastGain(problem),
                                                        Differences::kForward));
  RunAll(model, nullptr, fits);
  std::erase_if(fits, [](const std::unique_ptr<LevenbergMarquardt>& fit) { return !fit->result().valid; });
  std::stable_sort(fits.begin(), fits.end(),
                   [](const auto& a, const auto& b) { return a->result().cost < b->result().cost; });
  fits.resize(std::min(fits.size(), most_fits));
  for (const std::unique_ptr<LevenbergMarquardt>& fit : fits) fit->Continue(max_iterations, LeastGainOfFirst(problem));
  RunAll(model, nullptr, fits);
  FitResult best;
  for (const std::unique_ptr<LevenbergMarquardt>& fit : fits)
    if (fit->result().valid && (!best.valid || fit->result().cost < best.cost)) best = std::move(fit->result());
  return Complete(model, std::move(best));
}

Eigen::MatrixXd Covariance(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows, const FitResult& fit) {
  const Eigen::Index size = model.num_parameters();
  Eigen::MatrixXd information = PriorPrecision(model).asDiagonal();
  const double precision = 1.0 / (fit.error_sd * fit.error_sd + 1e-300);
  for (const Eigen::Index k : CountedRows(model, rows))
    information += precision * fit.jacobian.row(k).transpose() * fit.jacobian.row(k);
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  const Eigen::MatrixXd covariance = scaled.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

}  // namespace armcmc::identify
