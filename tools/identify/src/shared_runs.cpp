#include "shared_runs.hpp"

#include <cstddef>
#include <utility>

namespace armcmc::identify {

void RunTogether(const TrajectoryModel& model, const std::vector<Eigen::Index>* wanted,
                 const std::vector<PredictionUser*>& all) {
  constexpr Eigen::Index kTogether = 96;  // candidates whose predictions are kept at a time
  Eigen::MatrixXd predictions;
  for (bool any = true; any;) {
    any = false;
    for (std::size_t next = 0; next < all.size();) {
      std::vector<std::pair<PredictionUser*, Eigen::MatrixXd>> part;
      Eigen::Index columns = 0;
      for (; next < all.size() && columns < kTogether; ++next) {
        if (all[next]->done()) continue;
        part.emplace_back(all[next], all[next]->Request());
        columns += part.back().second.cols();
      }
      if (part.empty()) break;
      any = true;
      Eigen::MatrixXd thetas(model.num_parameters(), columns);
      Eigen::Index first = 0;
      for (const auto& [user, request] : part) {
        thetas.middleCols(first, request.cols()) = request;
        first += request.cols();
      }
      model.Predict(thetas, &predictions, wanted);
      first = 0;
      for (const auto& [user, request] : part) {
        user->Receive(predictions.middleCols(first, request.cols()));
        first += request.cols();
      }
    }
  }
}

}  // namespace armcmc::identify
