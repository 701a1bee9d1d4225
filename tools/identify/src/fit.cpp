#include "armcmc/identify/fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace armcmc::identify {
namespace {

/// The rows that count.
std::vector<Eigen::Index> Counted(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows) {
  std::vector<Eigen::Index> counted;
  for (std::size_t n = 0; n < rows.size(); ++n)
    if (rows[n] != 0 && model.active()[n] != 0) counted.push_back(static_cast<Eigen::Index>(n));
  return counted;
}

double MeanSquare(const TrajectoryModel& model, const std::vector<Eigen::Index>& rows,
                  const Eigen::VectorXd& prediction) {
  double sum = 0.0;
  for (const Eigen::Index n : rows) sum += std::pow(model.target()[n] - prediction[n], 2);
  return sum / static_cast<double>(rows.size());
}

struct Problem {
  const TrajectoryModel& model;
  std::vector<Eigen::Index> rows;
  Eigen::VectorXd lower, upper, mean, precision, spread;

  [[nodiscard]] double Cost(const Eigen::VectorXd& theta, const Eigen::VectorXd& prediction) const {
    constexpr double kTiny = 1e-300;
    return 0.5 * static_cast<double>(rows.size()) * std::log(MeanSquare(model, rows, prediction) + kTiny) +
           0.5 * (theta - mean).cwiseAbs2().dot(precision);
  }
};

/// Normal equations in units of the prior's spread: what is small for one parameter is large for another.
struct Normal {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
};

/// @param squares  Sum of squared errors.
/// @param count    Of rows.
/// @param normal   J' J and J' e in units of the spread; the prior is added.
void AddPrior(const Problem& problem, const Eigen::VectorXd& theta, double squares, Eigen::Index count,
              Normal* normal) {
  // Errors weigh as much as they will after this step: those of a poor start would leave the prior alone.
  const Eigen::VectorXd unit = normal->matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = unit.asDiagonal() * normal->matrix * unit.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  const Eigen::VectorXd step = unit.cwiseProduct(scaled.ldlt().solve(unit.cwiseProduct(normal->right)));
  const double left = squares - 2.0 * normal->right.dot(step) + step.dot(normal->matrix * step);
  const double precision = static_cast<double>(count) / (std::max(left, 1e-13 * squares) + 1e-300);
  normal->matrix *= precision;
  normal->right *= precision;
  const Eigen::VectorXd pull = problem.precision.cwiseProduct(problem.spread.cwiseAbs2());
  normal->matrix.diagonal() += pull;
  normal->right -= pull.cwiseProduct((theta - problem.mean).cwiseQuotient(problem.spread));
  // A parameter at a bound that would leave it stays.
  for (Eigen::Index d = 0; d < theta.size(); ++d) {
    const bool held = (theta[d] <= problem.lower[d] && normal->right[d] < 0.0) ||
                      (theta[d] >= problem.upper[d] && normal->right[d] > 0.0);
    if (!held) continue;
    normal->matrix.row(d).setZero();
    normal->matrix.col(d).setZero();
    normal->matrix(d, d) = 1.0;
    normal->right[d] = 0.0;
  }
}

Normal NormalEquations(const Problem& problem, const FitResult& fit) {
  Eigen::MatrixXd jacobian = fit.jacobian(problem.rows, Eigen::all);
  jacobian *= problem.spread.asDiagonal();
  const Eigen::VectorXd error = (problem.model.target() - fit.prediction)(problem.rows);
  Normal normal{jacobian.transpose() * jacobian, jacobian.transpose() * error};
  AddPrior(problem, fit.theta, error.squaredNorm(), error.size(), &normal);
  return normal;
}

/// Where steps of these dampings lead, a column each.
Eigen::MatrixXd Steps(const Problem& problem, const Eigen::VectorXd& theta, const Normal& normal,
                      const std::vector<double>& dampings) {
  Eigen::MatrixXd thetas(theta.size(), static_cast<Eigen::Index>(dampings.size()));
  // At unit diagonal, so that what is small in its unit is not lost beside what is large.
  const Eigen::VectorXd size = normal.matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd matrix = size.asDiagonal() * normal.matrix * size.asDiagonal();
  const Eigen::VectorXd right = size.cwiseProduct(normal.right);
  for (std::size_t trial = 0; trial < dampings.size(); ++trial) {
    Eigen::MatrixXd damped = matrix;
    damped.diagonal().array() += dampings[trial] + 1e-12;
    const Eigen::VectorXd step = damped.ldlt().solve(right).cwiseProduct(size).cwiseProduct(problem.spread);
    thetas.col(static_cast<Eigen::Index>(trial)) = (theta + step).cwiseMax(problem.lower).cwiseMin(problem.upper);
  }
  return thetas;
}

/// From a hundredth of `damping` up.
std::vector<double> Dampings(double damping) {
  constexpr std::size_t kTrials = 8;
  constexpr double kRatio = 8.0;
  std::vector<double> dampings{damping / (kRatio * kRatio)};
  while (dampings.size() < kTrials) dampings.push_back(kRatio * dampings.back());
  return dampings;
}

Problem MakeProblem(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows) {
  return {model,         Counted(model, rows),  model.Lower(), model.Upper(),
          model.Start(), PriorPrecision(model), model.Spread()};
}

/// A computation that asks for predictions step by step, so that several can share the runs of a model.
class Asking {
 public:
  Asking() = default;
  Asking(const Asking&) = delete;
  Asking& operator=(const Asking&) = delete;
  virtual ~Asking() = default;
  [[nodiscard]] bool done() const { return done_; }
  /// Parameters whose predictions come next, a column each. Not where it is done.
  [[nodiscard]] virtual Eigen::MatrixXd Asks() = 0;
  /// @param predictions  [row][candidate] As of TrajectoryModel::Predict.
  virtual void Take(const Eigen::Ref<const Eigen::MatrixXd>& predictions) = 0;

 protected:
  bool done_ = false;
};

/// Goes on with all of them until they are done. A run has room for TrajectoryModel's lanes, of which one fit fills a
/// part; predictions do not depend on what stands beside them.
/// @param wanted  Rows that predictions are needed at; null: all.
void Finish(const TrajectoryModel& model, const std::vector<Eigen::Index>* wanted, const std::vector<Asking*>& all) {
  constexpr Eigen::Index kTogether = 96;  // candidates whose predictions are kept at a time
  Eigen::MatrixXd predictions;
  for (bool any = true; any;) {
    any = false;
    for (std::size_t next = 0; next < all.size();) {
      std::vector<std::pair<Asking*, Eigen::MatrixXd>> part;
      Eigen::Index columns = 0;
      for (; next < all.size() && columns < kTogether; ++next) {
        if (all[next]->done()) continue;
        part.emplace_back(all[next], all[next]->Asks());
        columns += part.back().second.cols();
      }
      if (part.empty()) break;
      any = true;
      Eigen::MatrixXd thetas(model.num_parameters(), columns);
      Eigen::Index first = 0;
      for (const auto& [asking, its] : part) {
        thetas.middleCols(first, its.cols()) = its;
        first += its.cols();
      }
      model.Predict(thetas, &predictions, wanted);
      first = 0;
      for (const auto& [asking, its] : part) {
        asking->Take(predictions.middleCols(first, its.cols()));
        first += its.cols();
      }
    }
  }
}

/// Finish() for objects of one kind.
template <class Kind>
void FinishAll(const TrajectoryModel& model, const std::vector<Eigen::Index>* wanted,
               const std::vector<std::unique_ptr<Kind>>& all) {
  std::vector<Asking*> asking;
  for (const std::unique_ptr<Kind>& one : all) asking.push_back(one.get());
  Finish(model, wanted, asking);
}

/// Levenberg-Marquardt, see Fit().
class Fitting : public Asking {
 public:
  /// @param problem     Not copied.
  /// @param least_gain  Of the cost by one step: less ends the fit.
  Fitting(const Problem& problem, const Eigen::VectorXd& start, int max_iterations, double least_gain)
      : problem_(problem), max_iterations_(max_iterations), least_gain_(least_gain) {
    fit_.theta = start.cwiseMax(problem.lower).cwiseMin(problem.upper);
    done_ = problem.rows.empty();
  }

  [[nodiscard]] Eigen::MatrixXd Asks() override {
    thetas_ = linearises_ ? problem_.model.Around(fit_.theta)
                          : Steps(problem_, fit_.theta, NormalEquations(problem_, fit_), Dampings(damping_));
    return thetas_;
  }
  void Take(const Eigen::Ref<const Eigen::MatrixXd>& predictions) override {
    if (!linearises_) {
      TakeSteps(predictions);
    } else if (!TrajectoryModel::LineariseFrom(thetas_, predictions, &fit_.prediction, &fit_.jacobian)) {
      fit_.valid = false;
      done_ = true;
    } else if (!fit_.valid) {
      fit_.valid = true;
      fit_.cost = problem_.Cost(fit_.theta, fit_.prediction);
      linearises_ = false;
      if (max_iterations_ <= 0) End();
    } else {
      linearises_ = false;
      if (gain_ < least_gain_)
        End();
      else
        Iterated();
    }
  }
  /// Once it is done.
  [[nodiscard]] FitResult& result() { return fit_; }

 private:
  void TakeSteps(const Eigen::Ref<const Eigen::MatrixXd>& predictions) {
    Eigen::Index best = -1;
    double cost = fit_.cost;
    for (Eigen::Index trial = 0; trial < thetas_.cols(); ++trial) {
      if (!thetas_.col(trial).allFinite() || !std::isfinite(predictions(0, trial))) continue;
      const double its = problem_.Cost(thetas_.col(trial), predictions.col(trial));
      if (its < cost) {
        cost = its;
        best = trial;
      }
    }
    if (best < 0) {
      if (damping_ > 1e6) {
        End();
      } else {
        damping_ *= 1e5;
        Iterated();
      }
      return;
    }
    gain_ = fit_.cost - cost;
    damping_ = std::clamp(damping_ * std::pow(8.0, static_cast<double>(best) - 2.0), 1e-7, 1e6);
    fit_.theta = thetas_.col(best);
    fit_.cost = cost;
    linearises_ = true;
  }
  void Iterated() {
    if (++fit_.iterations >= max_iterations_) End();
  }
  void End() {
    fit_.error_sd = std::sqrt(MeanSquare(problem_.model, problem_.rows, fit_.prediction));
    done_ = true;
  }

  const Problem& problem_;
  const int max_iterations_;
  const double least_gain_;
  FitResult fit_;
  Eigen::MatrixXd thetas_;
  bool linearises_ = true;
  double damping_ = 1e-2, gain_ = 0.0;
};

double LeastGain(const Problem& problem) { return 1e-3 + 1e-7 * static_cast<double>(problem.rows.size()); }

/// A start that is moved along one parameter at a time, the one that helps most: a parameter that is far off is
/// corrected without the others running away.
class MovingAlongOne : public Asking {
 public:
  MovingAlongOne(const Problem& problem, const Eigen::VectorXd& start, int steps)
      : problem_(problem), steps_(steps), theta_(start.cwiseMax(problem.lower).cwiseMin(problem.upper)) {
    done_ = steps == 0 || problem.rows.empty();
  }

  [[nodiscard]] Eigen::MatrixXd Asks() override {
    if (linearises_) thetas_ = problem_.model.Around(theta_);
    return thetas_;
  }
  void Take(const Eigen::Ref<const Eigen::MatrixXd>& predictions) override {
    if (linearises_) {
      TakeLinearised(predictions);
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
  void TakeLinearised(const Eigen::Ref<const Eigen::MatrixXd>& predictions) {
    Eigen::VectorXd prediction;
    Eigen::MatrixXd jacobian;
    if (!TrajectoryModel::LineariseFrom(thetas_, predictions, &prediction, &jacobian)) {
      done_ = true;
      return;
    }
    const Eigen::VectorXd error = (problem_.model.target() - prediction)(problem_.rows);
    thetas_ = theta_.replicate(1, theta_.size() + 1);
    for (Eigen::Index d = 0; d < theta_.size(); ++d) {
      const Eigen::VectorXd along = jacobian.col(d)(problem_.rows);
      const double move = along.dot(error) / (along.squaredNorm() + 1e-300);
      thetas_(d, d) = std::clamp(theta_[d] + move, problem_.lower[d], problem_.upper[d]);
    }
    linearises_ = false;
  }

  const Problem& problem_;
  int steps_;
  Eigen::VectorXd theta_;
  Eigen::MatrixXd thetas_;
  bool linearises_ = true;
};

/// Derivatives at some rows by differences to one side, in units of the spread.
class OneSided : public Asking {
 public:
  OneSided(const Problem& problem, const Eigen::VectorXd& theta, const std::vector<Eigen::Index>& rows)
      : problem_(problem), theta_(theta), rows_(rows) {}

  [[nodiscard]] Eigen::MatrixXd Asks() override {
    constexpr double kStep = 1e-5;
    thetas_ = theta_.replicate(1, theta_.size() + 1);
    for (Eigen::Index d = 0; d < theta_.size(); ++d) {
      const double step = kStep * problem_.spread[d];
      thetas_(d, d) += theta_[d] + step > problem_.upper[d] ? -step : step;
    }
    return thetas_;
  }
  void Take(const Eigen::Ref<const Eigen::MatrixXd>& predictions) override {
    done_ = true;
    finite_ = predictions.row(0).allFinite();
    if (!finite_) return;
    const Eigen::VectorXd here = predictions.col(theta_.size())(rows_);
    jacobian_.resize(here.size(), theta_.size());
    for (Eigen::Index d = 0; d < theta_.size(); ++d)
      jacobian_.col(d) = (predictions.col(d)(rows_) - here) * (problem_.spread[d] / (thetas_(d, d) - theta_[d]));
  }
  [[nodiscard]] bool finite() const { return finite_; }
  [[nodiscard]] const Eigen::MatrixXd& jacobian() const { return jacobian_; }

 private:
  const Problem& problem_;
  const Eigen::VectorXd theta_;
  const std::vector<Eigen::Index>& rows_;
  Eigen::MatrixXd thetas_, jacobian_;
  bool finite_ = false;
};

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
  const Problem problem = MakeProblem(model, rows);
  Fitting fitting(problem, start, max_iterations, LeastGain(problem));
  Finish(model, nullptr, {&fitting});
  return std::move(fitting.result());
}

FitResult BestFit(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows,
                  const std::vector<Eigen::VectorXd>& starts, std::size_t most_fits, int max_iterations,
                  bool along_one) {
  constexpr int kAlong = 3, kFirst = 2;
  const Problem problem = MakeProblem(model, rows);
  std::vector<std::unique_ptr<MovingAlongOne>> moved;
  for (const Eigen::VectorXd& start : starts)
    moved.push_back(std::make_unique<MovingAlongOne>(problem, start, along_one ? kAlong : 0));
  FinishAll(model, nullptr, moved);
  std::vector<std::unique_ptr<Fitting>> fits;
  for (const std::unique_ptr<MovingAlongOne>& start : moved)
    fits.push_back(std::make_unique<Fitting>(problem, start->theta(), kFirst, LeastGain(problem)));
  FinishAll(model, nullptr, fits);
  std::erase_if(fits, [](const std::unique_ptr<Fitting>& fit) { return !fit->result().valid; });
  std::stable_sort(fits.begin(), fits.end(),
                   [](const auto& a, const auto& b) { return a->result().cost < b->result().cost; });
  fits.resize(std::min(fits.size(), most_fits));
  for (std::unique_ptr<Fitting>& fit : fits)
    fit = std::make_unique<Fitting>(problem, fit->result().theta, max_iterations, LeastGain(problem));
  FinishAll(model, nullptr, fits);
  FitResult best;
  for (const std::unique_ptr<Fitting>& fit : fits)
    if (fit->result().valid && (!best.valid || fit->result().cost < best.cost)) best = std::move(fit->result());
  return best;
}

FitsWithout FitWithoutEach(const TrajectoryModel& model, const FitResult& all, const std::vector<Eigen::Index>& rows,
                           const std::vector<std::vector<Eigen::Index>>& groups, int max_iterations) {
  constexpr int kWithTheSame = 2;
  constexpr double kMoves = 0.1;  // of the cost
  const std::vector<double> dampings{0.0, 1e-2, 1.0, 100.0};
  Problem problem = MakeProblem(model, std::vector<std::uint8_t>(model.num_rows(), 0));
  problem.rows = rows;
  const auto num_groups = static_cast<Eigen::Index>(groups.size());
  const auto trials = static_cast<Eigen::Index>(dampings.size());
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
  // Steps with the Jacobian of the fit to all rows tell most groups where to go, one with its own whether it is there.
  for (int iteration = 0; iteration <= kWithTheSame && !moving.empty(); ++iteration) {
    Eigen::MatrixXd thetas(all.theta.size(), static_cast<Eigen::Index>(moving.size()) * trials), predictions;
    std::vector<std::unique_ptr<OneSided>> own;
    for (std::size_t k = 0; k < moving.size() && iteration == kWithTheSame; ++k)
      own.push_back(std::make_unique<OneSided>(problem, fits.theta.col(moving[k]), rows));
    FinishAll(model, &rows, own);
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const Eigen::Index g = moving[k];
      const std::vector<Eigen::Index>& group = groups[static_cast<std::size_t>(g)];
      const Eigen::VectorXd e = fits.error.col(g), theta = fits.theta.col(g);
      Normal normal;
      if (!own.empty() && own[k]->finite()) {
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
      thetas.middleCols(static_cast<Eigen::Index>(k) * trials, trials) = Steps(problem, theta, normal, dampings);
    }
    model.Predict(thetas, &predictions, &rows);
    std::vector<Eigen::Index> still;
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const Eigen::Index g = moving[k];
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
      if (iteration < kWithTheSame || before - best > kMoves) still.push_back(g);
    }
    moving = std::move(still);
  }
  // Those that are not are fitted for themselves.
  std::vector<Problem> problems(moving.size(), problem);
  std::vector<std::unique_ptr<Fitting>> fitting;
  for (std::size_t m = 0; m < moving.size(); ++m) {
    const Eigen::Index g = moving[m];
    std::vector<std::uint8_t> in_group(rows.size(), 0);
    for (const Eigen::Index k : groups[static_cast<std::size_t>(g)]) in_group[static_cast<std::size_t>(k)] = 1;
    problems[m].rows.clear();
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (in_group[k] == 0) problems[m].rows.push_back(rows[k]);
    fitting.push_back(std::make_unique<Fitting>(problems[m], fits.theta.col(g), max_iterations, kMoves));
  }
  FinishAll(model, &rows, fitting);
  for (std::size_t m = 0; m < moving.size(); ++m) {
    const FitResult& fit = fitting[m]->result();
    if (!fit.valid) continue;
    fits.theta.col(moving[m]) = fit.theta;
    fits.error.col(moving[m]) = (model.target() - fit.prediction)(rows);
    fits.jacobian[static_cast<std::size_t>(moving[m])] = fit.jacobian(rows, Eigen::all);
  }
  return fits;
}

Eigen::MatrixXd Covariance(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows, const FitResult& fit) {
  const Eigen::Index size = model.num_parameters();
  Eigen::MatrixXd information = PriorPrecision(model).asDiagonal();
  const double precision = 1.0 / (fit.error_sd * fit.error_sd + 1e-300);
  for (const Eigen::Index k : Counted(model, rows))
    information += precision * fit.jacobian.row(k).transpose() * fit.jacobian.row(k);
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  const Eigen::MatrixXd covariance = scaled.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

}  // namespace armcmc::identify
