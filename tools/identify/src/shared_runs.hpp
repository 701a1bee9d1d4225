#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"

namespace armcmc::identify {

/// A computation that requests predictions step by step, so that several can share the runs of a model.
class PredictionUser {
 public:
  PredictionUser() = default;
  PredictionUser(const PredictionUser&) = delete;
  PredictionUser& operator=(const PredictionUser&) = delete;
  virtual ~PredictionUser() = default;
  [[nodiscard]] bool done() const { return done_; }
  /// The parameters that it needs predictions of, a column each. Not to be called when done() is true.
  [[nodiscard]] virtual Eigen::MatrixXd Request() = 0;
  /// @param predictions  [row][column of the request] From TrajectoryModel::Predict.
  virtual void Receive(const Eigen::Ref<const Eigen::MatrixXd>& predictions) = 0;

 protected:
  bool done_ = false;
};

/// Runs all of them until they are done. One run of the model has a number of lanes, of which a single fit fills only a
/// part; a prediction does not depend on the other lanes.
/// @param wanted  Rows whose predictions are needed; null: all.
void RunTogether(const TrajectoryModel& model, const std::vector<Eigen::Index>* wanted,
                 const std::vector<PredictionUser*>& all);

/// RunTogether() for objects of one class.
template <class Kind>
void RunAll(const TrajectoryModel& model, const std::vector<Eigen::Index>* wanted,
            const std::vector<std::unique_ptr<Kind>>& all) {
  std::vector<PredictionUser*> users;
  users.reserve(all.size());
  for (const std::unique_ptr<Kind>& one : all) users.push_back(one.get());
  RunTogether(model, wanted, users);
}

}  // namespace armcmc::identify
