#include "armcmc/gap/localise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "armcmc/gap/features.hpp"
#include "armcmc/support/parallel.hpp"

namespace armcmc::gap {
namespace {

constexpr int kDepth = 3;
constexpr double kMinLeaf = 0.05;         // of the rows
constexpr double kMinImprovement = 0.01;  // of the spread of the excess that a split must take
constexpr int kShifts = 400;

using Mask = std::vector<char>;

struct Split {
  std::size_t feature = 0;
  double threshold = 0.0;
  double gain = 0.0;
};

std::string Filled(const std::string& words, double threshold) {
  const std::size_t at = words.find("%s");
  if (at == std::string::npos) return words;
  char number[32];
  std::snprintf(number, sizeof(number), "%.3g", threshold);
  return words.substr(0, at) + number + words.substr(at + 2);
}

class Tree {
 public:
  Tree(std::vector<SplitVariable> variables, Vector excess)
      : variables_(std::move(variables)), excess_(std::move(excess)) {
    Grow(Mask(static_cast<std::size_t>(excess_.size()), 1), "", kDepth);
  }
  struct Leaf {
    Mask rows;
    std::string words;
  };
  [[nodiscard]] const std::vector<Leaf>& leaves() const { return leaves_; }

 private:
  void Grow(const Mask& rows, const std::string& words, int depth) {
    const Split split = depth > 0 ? BestSplit(rows) : Split{};
    if (split.gain <= 0.0) {
      if (!words.empty()) leaves_.push_back({rows, words});
      return;
    }
    const SplitVariable& variable = variables_[split.feature];
    Mask below = rows, above = rows;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const bool is_below = variable.value[static_cast<Eigen::Index>(i)] <= split.threshold;
      (is_below ? above : below)[i] = 0;
    }
    const std::string joint = words.empty() ? "" : words + ", ";
    Grow(below, joint + Filled(variable.below, split.threshold), depth - 1);
    Grow(above, joint + Filled(variable.above, split.threshold), depth - 1);
  }

  [[nodiscard]] Split BestSplit(const Mask& rows) const {
    double count = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (rows[i] != 0) {
        count += 1.0;
        sum += excess_[static_cast<Eigen::Index>(i)];
      }
    Split best;
    const auto smallest = kMinLeaf * static_cast<double>(rows.size());
    for (std::size_t f = 0; f < variables_.size(); ++f) {
      for (const double threshold : variables_[f].thresholds) {
        double below_count = 0.0, below_sum = 0.0;
        for (std::size_t i = 0; i < rows.size(); ++i)
          if (rows[i] != 0 && variables_[f].value[static_cast<Eigen::Index>(i)] <= threshold) {
            below_count += 1.0;
            below_sum += excess_[static_cast<Eigen::Index>(i)];
          }
        const double above_count = count - below_count;
        if (below_count < smallest || above_count < smallest) continue;
        const double difference = below_sum / below_count - (sum - below_sum) / above_count;
        const double gain = difference * difference * below_count * above_count / count;
        const double mean = std::abs(sum) / count;
        if (gain > best.gain && gain > kMinImprovement * mean * mean * count) best = {f, threshold, gain};
      }
    }
    return best;
  }

  std::vector<SplitVariable> variables_;
  Vector excess_;
  std::vector<Leaf> leaves_;
};

/// Shares of an excess in a region that is shifted cyclically in time.
class Shifted {
 public:
  explicit Shifted(const Vector& excess) : total_(std::max(excess.sum(), 1e-300)), twice_(2 * excess.size()) {
    twice_ << excess, excess;
  }
  [[nodiscard]] double Share(const std::vector<Eigen::Index>& rows, std::size_t shift) const {
    const double* const from = twice_.data() + shift;
    double inside = 0.0;
    for (const Eigen::Index row : rows) inside += from[row];
    return inside / total_;
  }

 private:
  double total_;
  Vector twice_;
};

std::vector<Eigen::Index> RowsOf(const Mask& mask) {
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i] != 0) rows.push_back(static_cast<Eigen::Index>(i));
  return rows;
}

}  // namespace

std::vector<Where> FindWhere(const Equation& equation, const Analysis& analysis, const BlockBootstrap& bootstrap,
                             unsigned long long seed) {
  const Fitted& base = analysis.finding.base->fit;
  const auto rows = static_cast<double>(analysis.signals.rows());
  const double variance = analysis.fitter->whitener().variance;
  const AdequacyCheck& adequacy_check = analysis.search->adequacy_check();
  std::vector<Where> found;
  const double explainable = std::max(analysis.finding.gap, 1e-12);
  found.resize(adequacy_check.groups().size());
  support::InParallel(found.size(), [&](std::size_t i) {
    const std::string& name = adequacy_check.groups()[i].name;
    const Vector gain = adequacy_check.GainOf(base, {name}, Matrix(analysis.signals.rows(), 0));
    const double size = std::max(2.0 * gain.sum() / rows, 0.0);
    found[i] = {name, "", std::clamp(size / explainable, 0.0, 1.0), size, 1.0 - bootstrap.ProbabilityAbove(gain, 0.0)};
  });
  const Line line = StrongestLine(base.whitened_residual, analysis.signals.dt);
  const Vector gain = adequacy_check.GainOf(base, {}, Waves(analysis.signals.t, line.frequency, 1, 1));
  char words[64];
  std::snprintf(words, sizeof(words), "a line at %.3g Hz", line.frequency);
  const double size = std::max(2.0 * gain.sum() / rows, 0.0);
  found.push_back({"frequency", words, std::clamp(size / explainable, 0.0, 1.0), size,
                   1.0 - bootstrap.ProbabilityAbove(gain, 0.0)});
  std::stable_sort(found.begin(), found.end(),
                   [](const Where& a, const Where& b) { return a.effect_size > b.effect_size; });

  const Vector excess = base.whitened_residual.array().square() / variance - 1.0;
  if (excess.sum() <= 0.0) return found;
  const Tree tree(equation.SplitVariables(analysis.signals), excess);
  std::vector<Where> regions;
  std::mt19937_64 engine(seed);
  const Shifted shifted(excess);
  for (const Tree::Leaf& leaf : tree.leaves()) {
    const std::vector<Eigen::Index> inside_rows = RowsOf(leaf.rows);
    const double share = shifted.Share(inside_rows, 0);
    int as_large = 0;
    for (int i = 0; i < kShifts; ++i) {
      const auto shift = static_cast<std::size_t>(engine() % leaf.rows.size());
      as_large += shifted.Share(inside_rows, shift) >= share ? 1 : 0;
    }
    double inside = 0.0;
    for (const Eigen::Index row : inside_rows) inside += excess[row];
    regions.push_back({"region", leaf.words, std::clamp(share, 0.0, 1.0), std::max(inside / rows, 0.0),
                       (as_large + 1.0) / (kShifts + 1.0)});
  }
  std::stable_sort(regions.begin(), regions.end(),
                   [](const Where& a, const Where& b) { return a.share_of_excess > b.share_of_excess; });
  found.insert(found.end(), regions.begin(), regions.end());
  return found;
}

}  // namespace armcmc::gap
