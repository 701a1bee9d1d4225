// The whole recursion of a plant with one parameter against an offline filter that shares no code with it.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
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
constexpr int kHypotheses = Drift::NumHypotheses(1);

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

/// What a pack says of a parameter that is a at its end and moves towards it at a constant speed: sums over the samples
/// of x^2 and x y, times powers of the time to the end of the pack.
struct Sums {
  double xx = 0.0, xy = 0.0, xx_lag = 0.0, xy_lag = 0.0, xx_lag_lag = 0.0;
};

/// Bayes' rule for the three-part prior. Given which hypothesis began in which pack, and when
/// the parameter changed, (u, w) is Gaussian; of these histories, which grow in number with every pack, thousands are
/// kept, the most probable ones. Of the others, those of the same law that began, or changed, in the same pack last are
/// one: newcomers are improbable and wide, and what they become is not what old histories of their law do.
class Histories {
 public:
  explicit Histories(double share) : share_(share) {
    for (int h = 0; h < kHypotheses; ++h) noise_[static_cast<std::size_t>(h)] = Noise(Drift::Of(h, share, 1));
  }

  /// @param persisted  Share of what did not change in the prior of the pack. 0: a modification.
  void Add(double persisted, const Sums& sums) {
    ++pack_;
    std::vector<History> next;
    const double stays = std::exp(-Drift::kSwitching * kDuration);
    if (histories_.empty()) {
      // What begins with the first pack moves from then on.
      for (int h = 0; h < kHypotheses; ++h) next.push_back(Begin(h, {1.0, h, 0, false, 0.0, 0.0, 1.0, 0.0, 0.0}));
    } else {
      for (const History& old : histories_) {
        std::vector<History> moved;
        History same = old;
        same.weight *= stays;
        moved.push_back(same);
        for (int h = 0; h < kHypotheses; ++h) {
          History begun = Begin(h, old);
          begun.weight *= 1.0 - stays;
          moved.push_back(begun);
        }
        for (const History& m : moved) {
          History kept = Propagated(m);
          History changed = kept;
          kept.weight *= persisted;
          changed.weight *= 1.0 - persisted;
          changed.since = pack_;
          changed.changed = true;
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
      log_weight.push_back(std::log(h.weight) + Update(sums, &h));
      top = std::fmax(top, log_weight.back());
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < next.size(); ++i) sum += next[i].weight = std::exp(log_weight[i] - top);
    for (History& h : next) h.weight /= sum;
    std::sort(next.begin(), next.end(), [](const History& a, const History& b) { return a.weight > b.weight; });
    constexpr std::size_t kMost = 4000;
    if (next.size() > kMost) {
      const std::vector<History> rest(next.begin() + static_cast<std::ptrdiff_t>(kMost), next.end());
      next.resize(kMost);
      Lump(rest, &next);
    }
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
    int since;     ///< Pack in which the law began, or in which the parameter changed after that.
    bool changed;  ///< It did.
    double u, w, uu, uw, ww;
  };

  /// y = (kMean + kSd (u - lag w)) x + e. @return Log evidence.
  static double Update(const Sums& s, History* h) {
    constexpr double kPrecision = 1.0 / (kNoise * kNoise);
    // Gradient at u = w = 0, and the information: of u, of w, and of both.
    const double g_u = kSd * (s.xy - kMean * s.xx) * kPrecision;
    const double g_w = -kSd * (s.xy_lag - kMean * s.xx_lag) * kPrecision;
    const double i_uu = kSd * kSd * s.xx * kPrecision;
    const double i_uw = -kSd * kSd * s.xx_lag * kPrecision;
    const double i_ww = kSd * kSd * s.xx_lag_lag * kPrecision;
    const double at_prior =
        g_u * h->u + g_w * h->w - 0.5 * (i_uu * h->u * h->u + 2.0 * i_uw * h->u * h->w + i_ww * h->w * h->w);
    const double r_u = g_u - i_uu * h->u - i_uw * h->w;
    const double r_w = g_w - i_uw * h->u - i_ww * h->w;
    // C (1 + I C)^-1.
    const double a = 1.0 + i_uu * h->uu + i_uw * h->uw;
    const double b = i_uu * h->uw + i_uw * h->ww;
    const double c = i_uw * h->uu + i_ww * h->uw;
    const double d = 1.0 + i_uw * h->uw + i_ww * h->ww;
    const double determinant = a * d - b * c;
    const double uu = (h->uu * d - h->uw * c) / determinant;
    const double uw = (h->uw * a - h->uu * b) / determinant;
    const double ww = (h->ww * a - h->uw * b) / determinant;
    h->uu = uu;
    h->uw = uw;
    h->ww = ww;
    const double move_u = uu * r_u + uw * r_w;
    const double move_w = uw * r_u + ww * r_w;
    h->u += move_u;
    h->w += move_w;
    return at_prior + 0.5 * (r_u * move_u + r_w * move_w) - 0.5 * std::log(determinant);
  }

  /// One history with the moments of all those of one law since one pack.
  static void Lump(const std::vector<History>& all, std::vector<History>* to) {
    std::map<std::tuple<int, int, bool>, History> lumps;
    for (const History& h : all) {
      if (!(h.weight > 0.0)) continue;
      const History none{0.0, h.law, h.since, h.changed, 0.0, 0.0, 0.0, 0.0, 0.0};
      History& sum = lumps.try_emplace({h.law, h.since, h.changed}, none).first->second;
      // By West's recursion; the second moments are sums until all are in.
      const double before = sum.weight;
      sum.weight += h.weight;
      const double share = h.weight / sum.weight, u = h.u - sum.u, w = h.w - sum.w;
      sum.u += share * u;
      sum.w += share * w;
      sum.uu += h.weight * h.uu + before * share * u * u;
      sum.uw += h.weight * h.uw + before * share * u * w;
      sum.ww += h.weight * h.ww + before * share * w * w;
    }
    for (auto& [key, sum] : lumps) {
      sum.uu /= sum.weight;
      sum.uw /= sum.weight;
      sum.ww /= sum.weight;
      to->push_back(sum);
    }
  }

  [[nodiscard]] History Begin(int h, History from) const {
    from.weight *= Drift::Of(h, share_, 1).prior;
    from.law = h;
    from.since = pack_;
    from.changed = false;
    return Turn(from);
  }
  [[nodiscard]] History Turn(History from) const {
    const Drift::Hypothesis law = Drift::Of(from.law, share_, 1);
    from.w = from.uw = 0.0;
    from.ww = law.rate * law.rate;
    return from;
  }
  [[nodiscard]] History Propagated(History h) const {
    if (h.law == 0) return h;
    const Noise& noise = noise_[static_cast<std::size_t>(h.law)];
    const double t = Drift::Of(h.law, share_, 1).persistence;
    const double phi = std::exp(-kDuration / t), b = t * (1.0 - phi);
    h.uu += 2.0 * b * h.uw + b * b * h.ww + noise.uu;
    h.u += b * h.w;
    h.uw = phi * (h.uw + b * h.ww) + noise.uw;
    h.ww = phi * phi * h.ww + noise.ww;
    h.w *= phi;
    return h;
  }

  /// What a speed that is known where the pack before ended adds until this one ends.
  struct Noise {
    double uu = 0.0, uw = 0.0, ww = 0.0;
    Noise() = default;
    /// By small steps: nothing of the estimator's closed form.
    explicit Noise(const Drift::Hypothesis& law) {
      constexpr int kSteps = 2000;
      constexpr double kStep = kDuration / kSteps;
      const double kept = std::exp(-kStep / law.persistence);
      for (int k = 0; k < kSteps; ++k) {
        uu += 2.0 * kStep * uw + kStep * kStep * ww;
        uw = kept * (uw + kStep * ww);
        ww = kept * kept * ww + law.rate * law.rate * (1.0 - kept * kept);
      }
    }
  };

  std::array<Noise, kHypotheses> noise_;
  double share_;
  int pack_ = 0;
  std::vector<History> histories_;
};

/// Of the estimator from the filter of all histories, over the packs of a run: root mean squares and largest values.
struct Difference {
  double mean = 0.0, sd = 0.0;  ///< In standard deviations, and relative.
  double worst_mean = 0.0, worst_sd = 0.0;
  double share = 0.0;    ///< Of the probability of drift, while nothing is taken for changed.
  double changed = 0.0;  ///< Largest p_changed where the prior gives a change at this pack less than a thousandth.
  int modifications = 0;
  int far = 0;  ///< Packs with more than .05 standard deviations, or 3 %.
};

/// At rest, then a drift, which goes on through a jump, and stops.
Difference DifferenceInARun(std::uint64_t noise_seed) {
  const auto plant = Plant();
  EstimatorSettings settings = DescribedSettings(plant);
  settings.gap_watch.enabled = false;
  settings.forgetting.partial_change = false;  // with one parameter a change in part is a change
  settings.forgetting.drift_share = 0.3;
  test::Rig rig(settings);
  Histories exact(settings.forgetting.drift_share);
  test::Normal normal(noise_seed);
  Difference d;
  for (std::int64_t seq = 1; seq <= kPacks; ++seq) {
    const DataPack pack = test::DescribedPack(*plant, seq, [&](double t) {
      const double a = 1.2 + 0.15 * (std::clamp(t, 4.0, 12.0) - 4.0) - (t > 9.0 ? 2.0 : 0.0);
      test::PlantSample s;
      s.u[0] = 0.5 + 0.4 * std::sin(9.0 * t);
      s.y = a * s.u[0] + kNoise * normal();
      return s;
    });
    Sums sums;
    for (int n = 0; n < pack.num_samples; ++n) {
      const auto i = static_cast<std::size_t>(n);
      const double x = pack.u[i][0];
      const double lag = seq == 1 ? 0.0 : (pack.num_samples - 1 - n) * pack.dt;  // nothing drifts before the first pack
      sums.xx += x * x;
      sums.xy += x * pack.y[i];
      sums.xx_lag += lag * x * x;
      sums.xy_lag += lag * x * pack.y[i];
      sums.xx_lag_lag += lag * lag * x * x;
    }
    const ModeEstimate& e = rig.Step(pack).modes[0];
    d.modifications += e.decision == Decision::kModification ? 1 : 0;
    exact.Add(e.decision == Decision::kModification ? 0.0 : e.lambda, sums);
    const double off = (e.marginal[0].ar_ap - exact.Mean()) / exact.Sd();
    const double wider = e.marginal[0].is_sd / exact.Sd() - 1.0;
    d.mean += off * off / kPacks;
    d.sd += wider * wider / kPacks;
    d.far += std::fabs(off) > 0.05 || std::fabs(wider) > 0.03 ? 1 : 0;
    d.worst_mean = std::fmax(d.worst_mean, std::fabs(off));
    d.worst_sd = std::fmax(d.worst_sd, std::fabs(wider));
    if (e.lambda > 0.999) d.changed = std::fmax(d.changed, e.p_changed);
    if (e.decision == Decision::kReinforcement) d.share = std::fmax(d.share, std::fabs(e.p_drifted - exact.Drifting()));
  }
  d.mean = std::sqrt(d.mean);
  d.sd = std::sqrt(d.sd);
  return d;
}

void Record(std::uint64_t noise_seed, const Difference& d) {
  const auto record = [&](const char* what, double value) {
    ::testing::Test::RecordProperty(what + ("_" + std::to_string(noise_seed)), std::to_string(value));
  };
  record("mean_sd", d.mean);
  record("sd_relative", d.sd);
  record("worst_mean_sd", d.worst_mean);
  record("worst_sd_relative", d.worst_sd);
  record("share", d.share);
  record("far", d.far);
}

TEST(DriftFilter, AgreesWithEveryHistoryThatMatters) {
  // In 108, what rests is improbable and then is not: few draws have told the shape of its density, the filters of the
  // bank know it. In 78 and 101 it is a change that is improbable: it is a third of the variance of pack 34, and soon
  // after pack 49 most of what rests.
  constexpr std::array<std::uint64_t, 11> kNoiseSeeds{31, 32, 33, 34, 35, 36, 37, 38, 78, 101, 108};
  int far = 0;
  for (const std::uint64_t noise_seed : kNoiseSeeds) {
    const Difference d = DifferenceInARun(noise_seed);
    Record(noise_seed, d);
    // A hundredth of it each is that of some thousand draws.
    EXPECT_LT(d.mean, 0.01) << noise_seed;
    EXPECT_LT(d.sd, 0.01) << noise_seed;
    EXPECT_LT(d.worst_mean, 0.06) << noise_seed;
    EXPECT_LT(d.worst_sd, 0.04) << noise_seed;
    EXPECT_LT(d.share, 0.05) << noise_seed;
    // What may have changed at the pack before has not changed at this one.
    EXPECT_LT(d.changed, 0.01) << noise_seed;
    EXPECT_EQ(d.modifications, 2) << noise_seed;
    far += d.far;
  }
  // Packs in which the mean is more than .05 standard deviations away, or the standard deviation more than 3 % off.
  EXPECT_LE(far, static_cast<int>(kNoiseSeeds.size()) * kPacks / 800);
}

// A pack may be far off, most of all after a change that was a few percent probable; no run has many of them.
TEST(LongDriftFilter, HasFewPacksThatAreFarOffInAnyRun) {
  constexpr std::uint64_t kFirst = 71;
  constexpr int kRuns = 40;
  int far = 0;
  for (std::uint64_t noise_seed = kFirst; noise_seed < kFirst + kRuns; ++noise_seed) {
    const Difference d = DifferenceInARun(noise_seed);
    Record(noise_seed, d);
    EXPECT_LE(d.far, kPacks / 32) << noise_seed;
    far += d.far;
  }
  EXPECT_LE(far, kRuns * kPacks / 800);
}

}  // namespace
}  // namespace armcmc::drift_filter_test
