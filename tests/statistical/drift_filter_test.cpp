// The whole recursion of a plant with one parameter against an offline filter that shares no code with it.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "armcmc/drift.hpp"
#include "core/estimator_rig.hpp"
#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::drift_filter_test {
namespace {

constexpr double kMean = 2.0, kSd = 1.0;  // of the prior of the parameter
constexpr double kNoise = 0.3;
constexpr double kDuration = 0.1;  // of a pack, s
constexpr int kPacks = 160;

/// y = a x.
std::shared_ptr<const PlantProgram> Plant() {
  PlantDescription plant;
  plant.name = "gain";
  plant.output = "y";
  plant.law = "a*x";
  plant.signals = {{"x", "1", "input", ""}, {"y", "V", "output", ""}};
  plant.parameters = {{"a", "V", "normal", kMean, kSd, kMean - 7.0 * kSd, kMean + 7.0 * kSd}};
  plant.noise.std = kNoise;
  return test::Program(plant);
}

/// Over the samples of a pack, of an input x at a time t before its end, and the output y.
struct Sums {
  double xx = 0.0, xy = 0.0, txx = 0.0, txy = 0.0, ttxx = 0.0;
};

/// Bayes' rule for the three-part prior. Given which hypothesis began in which pack, and when the parameter changed,
/// (u, w) is Gaussian; of these histories, which grow in number with every pack, thousands are kept, the most probable
/// ones.
class Histories {
 public:
  explicit Histories(double share) : share_(share) {}

  /// @param persisted  Share of what did not change in the prior of the pack. 0: a modification.
  /// @param sums       Over the pack.
  void Add(double persisted, const Sums& sums) {
    std::vector<History> next;
    const double switched = 1.0 - std::exp(-Drift::kSwitching * kDuration);
    const double turned = 1.0 - std::exp(-Drift::kTurning * kDuration);
    if (histories_.empty()) {
      // What begins with the first pack moves from its end on.
      for (int h = 0; h < Drift::kHypotheses; ++h) next.push_back(Begin(h, {1.0, h, 0.0, 0.0, 1.0, 0.0, 0.0, true}));
    } else {
      for (const History& old : histories_) {
        std::vector<History> moved;
        History same = old;
        const double goes_on = 1.0 - switched * (old.law > 0 ? 1.0 - share_ : share_);
        same.weight *= goes_on * (old.law > 0 ? 1.0 - turned : 1.0);
        moved.push_back(same);
        // A drift begins at rest, turns, and comes to rest.
        for (int h = 0; h < Drift::kHypotheses; ++h) {
          if (h == 0 && old.law == 0) continue;
          History begun = Begin(h, old);
          begun.weight *= h > 0 && old.law > 0 ? goes_on * turned / share_ : switched;
          moved.push_back(begun);
        }
        for (const History& m : moved) {
          // What has less would not be among those that are kept.
          if (m.weight < 1e-13) continue;
          History kept = Pass(m);
          History changed = kept;
          kept.weight *= persisted;
          changed.weight *= 1.0 - persisted;
          changed.new_in_pack = true;
          changed.u = changed.uw = 0.0;
          changed.uu = 1.0;
          if (kept.weight > 0.0) next.push_back(kept);
          if (changed.weight > 0.0) next.push_back(changed);
        }
      }
    }
    double top = -HUGE_VAL;
    std::vector<double> log_weight;
    for (History& h : next) {
      // y = (a - t w) x + e, a = kMean + kSd u: information and pull in u, then in w.
      const double unit = kSd / (kNoise * kNoise);
      // What has changed is constant for the rest of the pack.
      const double moves = !h.new_in_pack && h.law > 0 ? 1.0 : 0.0;
      h.new_in_pack = false;
      const double huu = kSd * unit * sums.xx, huw = -moves * kSd * unit * sums.txx;
      const double hww = moves * kSd * unit * sums.ttxx;
      const double pull = unit * (sums.xy - kMean * sums.xx), pull_w = -moves * unit * (sums.txy - kMean * sums.txx);
      // (1 + P H)^-1 P, and the step from what is left of the pull.
      const double a = 1.0 + h.uu * huu + h.uw * huw, b = h.uu * huw + h.uw * hww;
      const double c = h.uw * huu + h.ww * huw, d = 1.0 + h.uw * huw + h.ww * hww;
      const double determinant = a * d - b * c;
      const double left = pull - huu * h.u - huw * h.w, left_w = pull_w - huw * h.u - hww * h.w;
      const double uu = (d * h.uu - b * h.uw) / determinant, uw = (d * h.uw - b * h.ww) / determinant;
      const double ww = (a * h.ww - c * h.uw) / determinant;
      const double step = uu * left + uw * left_w, step_w = uw * left + ww * left_w;
      log_weight.push_back(std::log(h.weight) - 0.5 * std::log(determinant) + h.u * (pull + left) / 2.0 +
                           h.w * (pull_w + left_w) / 2.0 + 0.5 * (left * step + left_w * step_w));
      top = std::fmax(top, log_weight.back());
      h.u += step;
      h.w += step_w;
      h.uu = uu;
      h.uw = uw;
      h.ww = ww;
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < next.size(); ++i) sum += next[i].weight = std::exp(log_weight[i] - top);
    for (History& h : next) h.weight /= sum;
    std::sort(next.begin(), next.end(), [](const History& a, const History& b) { return a.weight > b.weight; });
    constexpr std::size_t kMost = 4000;
    if (next.size() > kMost) next.resize(kMost);
    histories_ = std::move(next);
  }

  [[nodiscard]] double Mean() const {
    double sum = 0.0, total = 0.0;
    for (const History& h : histories_) {
      total += h.weight;
      sum += h.weight * h.u;
    }
    return kMean + kSd * sum / total;
  }
  [[nodiscard]] double Sd() const {
    double square = 0.0, total = 0.0;
    const double mean = (Mean() - kMean) / kSd;
    for (const History& h : histories_) {
      total += h.weight;
      square += h.weight * (h.uu + (h.u - mean) * (h.u - mean));
    }
    return kSd * std::sqrt(square / total);
  }
  [[nodiscard]] double Drifting() const {
    double drifting = 0.0, total = 0.0;
    for (const History& h : histories_) {
      total += h.weight;
      drifting += h.law > 0 ? h.weight : 0.0;
    }
    return drifting / total;
  }

 private:
  struct History {
    double weight;
    int law;
    double u, w, uu, uw, ww;
    bool new_in_pack = false;
  };

  [[nodiscard]] History Begin(int h, History from) const {
    const Drift::Hypothesis law = Drift::Of(h, share_);
    from.weight *= law.prior;
    from.law = h;
    from.w = from.uw = 0.0;
    from.ww = law.rate * law.rate;
    return from;
  }
  [[nodiscard]] static History Pass(History h) {
    if (h.law == 0) return h;
    h.uu += 2.0 * kDuration * h.uw + kDuration * kDuration * h.ww;
    h.u += kDuration * h.w;
    h.uw += kDuration * h.ww;
    return h;
  }

  double share_;
  std::vector<History> histories_;
};

TEST(DriftFilter, AgreesWithEveryHistoryThatMatters) {
  const auto plant = Plant();
  EstimatorSettings settings = DescribedSettings(plant);
  settings.gap_watch.enabled = false;
  settings.forgetting.partial_change = false;  // with one parameter a change in part is a change
  settings.forgetting.drift_share = 0.3;
  test::Rig rig(settings);
  Histories exact(settings.forgetting.drift_share);
  test::Normal normal(31);
  double mean = 0.0, sd = 0.0, share = 0.0, worst_mean = 0.0, worst_sd = 0.0;
  int modifications = 0;
  for (std::int64_t seq = 1; seq <= kPacks; ++seq) {
    Sums sums;
    double before_end = kDuration;
    const DataPack pack = test::DescribedPack(*plant, seq, [&](double t) {
      // At rest, then a drift, which goes on through a jump, and stops.
      const double a = 1.2 + 0.15 * (std::clamp(t, 4.0, 12.0) - 4.0) - (t > 9.0 ? 2.0 : 0.0);
      test::PlantSample s;
      s.u[0] = 0.5 + 0.4 * std::sin(9.0 * t);
      s.y = a * s.u[0] + kNoise * normal();
      before_end -= test::kSampleInterval;
      sums.xx += s.u[0] * s.u[0];
      sums.xy += s.u[0] * s.y;
      sums.txx += before_end * s.u[0] * s.u[0];
      sums.txy += before_end * s.u[0] * s.y;
      sums.ttxx += before_end * before_end * s.u[0] * s.u[0];
      return s;
    });
    const ModeEstimate& e = rig.Step(pack).modes[0];
    modifications += e.decision == Decision::kModification ? 1 : 0;
    exact.Add(e.decision == Decision::kModification ? 0.0 : e.lambda, sums);
    const double off = (e.marginal[0].ar_ap - exact.Mean()) / exact.Sd();
    const double wider = e.marginal[0].is_sd / exact.Sd() - 1.0;
    mean += off * off / kPacks;
    sd += wider * wider / kPacks;
    worst_mean = std::fmax(worst_mean, std::fabs(off));
    worst_sd = std::fmax(worst_sd, std::fabs(wider));
    if (e.decision == Decision::kReinforcement) share = std::fmax(share, std::fabs(e.p_drifted - exact.Drifting()));
  }
  RecordProperty("mean_sd", std::to_string(std::sqrt(mean)));
  RecordProperty("sd_relative", std::to_string(std::sqrt(sd)));
  RecordProperty("worst_mean_sd", std::to_string(worst_mean));
  RecordProperty("worst_sd_relative", std::to_string(worst_sd));
  RecordProperty("share", std::to_string(share));
  // A hundredth of it each is that of some thousand draws.
  EXPECT_LT(std::sqrt(mean), 0.025);
  EXPECT_LT(std::sqrt(sd), 0.02);
  EXPECT_LT(worst_mean, 0.08);
  EXPECT_LT(worst_sd, 0.07);
  EXPECT_LT(share, 0.06);
  EXPECT_EQ(modifications, 2);
}

}  // namespace
}  // namespace armcmc::drift_filter_test
