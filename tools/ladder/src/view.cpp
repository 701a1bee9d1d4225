#include "armcmc/ladder/view.hpp"

#include <algorithm>

#include "armcmc/ladder/features.hpp"

namespace armcmc::ladder {
namespace {

constexpr int kBlocks = 8, kFolds = 5, kStretchesOfFold = 8;
constexpr double kTail = 0.15;

/// Long blocks of time within a run, and folds of short segments.
void AddBlocks(View* view) {
  const std::vector<std::size_t>& runs = view->data.series->runs;
  const std::size_t size = view->active_rows.size();
  const std::size_t length = (size + kBlocks - 1) / kBlocks;
  std::size_t run = 0, run_of_block = 0;
  for (std::size_t k = 0; k < size; ++k) {
    const auto n = static_cast<std::size_t>(view->active_rows[k]);
    while (run + 1 < runs.size() && runs[run + 1] <= n) ++run;
    if (view->groups.empty() || view->groups.back().rows.size() >= length || run != run_of_block) {
      view->groups.push_back({"from " + std::to_string(view->data.series->t[n]) + " s", GroupKind::kBlock, {}});
      run_of_block = run;
    }
    view->groups.back().rows.push_back(static_cast<Eigen::Index>(k));
  }
  view->num_stretches = kFolds * kStretchesOfFold;
  std::vector<RowGroup> folds(kFolds, {"every fifth stretch", GroupKind::kFold, {}});
  for (std::size_t k = 0; k < size; ++k) {
    const int stretch = static_cast<int>(k * static_cast<std::size_t>(view->num_stretches) / size);
    view->stretch.push_back(stretch);
    folds[static_cast<std::size_t>(stretch % kFolds)].rows.push_back(static_cast<Eigen::Index>(k));
  }
  view->groups.insert(view->groups.end(), folds.begin(), folds.end());
}

/// Regions: the rows with the lowest and the highest values of every feature.
void AddRegions(const std::vector<Feature>& features, View* view) {
  for (const Feature& feature : features) {
    std::vector<double> sorted;
    for (const Eigen::Index n : view->active_rows) sorted.push_back(feature.value[n]);
    std::sort(sorted.begin(), sorted.end());
    const auto at = static_cast<std::size_t>(kTail * static_cast<double>(sorted.size()));
    const double low = sorted[at], high = sorted[sorted.size() - 1 - at];
    RowGroup lowest{"lowest " + feature.name, GroupKind::kRegion, {}};
    RowGroup highest{"highest " + feature.name, GroupKind::kRegion, {}};
    for (std::size_t k = 0; k < view->active_rows.size(); ++k) {
      const double value = feature.value[view->active_rows[k]];
      if (value < low) lowest.rows.push_back(static_cast<Eigen::Index>(k));
      if (value > high) highest.rows.push_back(static_cast<Eigen::Index>(k));
    }
    // If many rows share a value, there may be none beyond it.
    for (RowGroup* group : {&lowest, &highest})
      if (group->rows.size() >= std::max<std::size_t>(at / 4, 1)) view->groups.push_back(std::move(*group));
  }
}

}  // namespace

View MakeView(const Dataset& data, const identify::TrajectoryModel& base, const Eigen::VectorXd& theta, double period) {
  constexpr std::size_t kMostRows = 4000;
  constexpr int kFlexible = 60;
  View view;
  view.data = data;
  view.period = period;
  std::vector<Eigen::Index> rows;
  for (std::size_t n = 0; n < data.training.size(); ++n)
    if (data.training[n] != 0 && base.active()[n] != 0) rows.push_back(static_cast<Eigen::Index>(n));
  const std::size_t every = std::max<std::size_t>((rows.size() + kMostRows - 1) / kMostRows, 1);
  for (std::size_t k = 0; k < rows.size(); k += every) view.active_rows.push_back(rows[k]);
  const std::vector<Feature> features = FeaturesOf(base, theta);
  AddBlocks(&view);
  AddRegions(features, &view);
  view.flexible = FlexibleFeatures(data, features, view.active_rows, period, kFlexible);
  return view;
}

}  // namespace armcmc::ladder
