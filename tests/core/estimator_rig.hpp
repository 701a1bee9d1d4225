#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <memory>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/settings.hpp"
#include "support/packs.hpp"
#include "support/same_bits.hpp"

namespace armcmc::test {

/// For the packs of Actuator.
inline EstimatorSettings ActuatorSettings() {
  EstimatorSettings settings = BuiltinSettings("soft_actuator_excited");
  for (NoiseSettings& noise : settings.noise) noise.std = 0.1;
  return settings;
}

/// An estimator with one slot, run stage after stage.
class Rig {
 public:
  explicit Rig(const EstimatorSettings& settings = BuiltinSettings("hunt_crossley"))
      : estimator(settings), result(estimator.MakeResult()), estimate_(std::make_unique<Estimate>()) {}

  const Estimate& Step(const DataPack& pack, Nanos deadline_ns = 0, ClockRef clock = {},
                       const DrawLimits& limits = kNoDrawLimits) {
    status = estimator.Adjust(pack, deadline_ns, clock, result.get(), limits);
    estimator.Execute(*result, estimate_.get());
    return *estimate_;
  }
  [[nodiscard]] const Estimate& estimate() const { return *estimate_; }

  Estimator estimator;
  std::unique_ptr<AdjustResult> result;
  Status status = Status::kOk;

 private:
  std::unique_ptr<Estimate> estimate_;
};

/// Everything that is computed, to the bit.
inline void ExpectSameBits(const Estimate& a, const Estimate& b) {
  EXPECT_EQ(a.seq, b.seq);
  EXPECT_EQ(a.mode, b.mode);
  EXPECT_EQ(a.report_mode, b.report_mode);
  EXPECT_TRUE(SameBits(a.y_pred, b.y_pred) && SameBits(a.y_lo, b.y_lo) && SameBits(a.y_hi, b.y_hi));
  EXPECT_TRUE(SameBits(a.y_rmse, b.y_rmse) && SameBits(a.y_free_run, b.y_free_run));
  ASSERT_EQ(a.num_samples, b.num_samples);
  for (std::size_t n = 0; n < static_cast<std::size_t>(a.num_samples); ++n) {
    EXPECT_TRUE(SameBits(a.y_shown[n], b.y_shown[n])) << n;
    EXPECT_TRUE(SameBits(a.y_shown_free_run[n], b.y_shown_free_run[n])) << n;
  }
  for (std::size_t m = 0; m < kMaxModes; ++m) {
    const ModeEstimate &p = a.modes[m], &q = b.modes[m];
    EXPECT_EQ(p.known, q.known);
    EXPECT_EQ(p.updated, q.updated);
    EXPECT_EQ(p.decision, q.decision);
    EXPECT_EQ(p.draws, q.draws);
    EXPECT_EQ(p.k_min, q.k_min);
    EXPECT_TRUE(SameBits(p.zeta, q.zeta) && SameBits(p.lambda, q.lambda) && SameBits(p.ess, q.ess));
    EXPECT_TRUE(SameBits(p.log_evidence, q.log_evidence) && SameBits(p.acceptance, q.acceptance));
    EXPECT_TRUE(SameBits(p.p_drifted, q.p_drifted) && SameBits(p.drift_rate[0], q.drift_rate[0]));
    EXPECT_TRUE(SameBits(p.p_changed, q.p_changed) && SameBits(p.noise_std, q.noise_std));
    static_assert(sizeof(MarginalSummary) == (12 + kHistogramBins) * sizeof(double), "no padding to compare");
    // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison,cert-exp42-c,cert-flp37-c): the bits are meant
    EXPECT_EQ(std::memcmp(&p.marginal, &q.marginal, sizeof p.marginal), 0) << "mode " << m;
  }
}

/// An estimate that a user can act on: finite, ordered, inside the bounds.
inline void ExpectUsable(const ModeEstimate& mode, const EstimatorSettings& settings) {
  EXPECT_TRUE(mode.known);
  EXPECT_GT(mode.draws, 0);
  EXPECT_GE(mode.lambda, 0.0);
  EXPECT_LT(mode.lambda, 1.0);
  EXPECT_TRUE(std::isfinite(mode.log_evidence));
  EXPECT_GE(mode.ess, 1.0);
  for (std::size_t d = 0; d < static_cast<std::size_t>(settings.num_parameters); ++d) {
    const MarginalSummary& m = mode.marginal[d];
    EXPECT_GE(m.q025, settings.parameters[d].lower);
    EXPECT_LE(m.q025, m.q25);
    EXPECT_LE(m.q25, m.q50);
    EXPECT_LE(m.q50, m.q75);
    EXPECT_LE(m.q75, m.q975);
    EXPECT_LE(m.q975, settings.parameters[d].upper);
    for (const double v : {m.ar_map, m.ar_ap, m.chain_mean}) {
      EXPECT_GE(v, settings.parameters[d].lower);
      EXPECT_LE(v, settings.parameters[d].upper);
    }
    EXPECT_GT(m.sd, 0.0);
    EXPECT_TRUE(std::isfinite(m.is_sd));
    double mass = 0.0;
    for (const double v : m.density) mass += v * (m.histogram_hi - m.histogram_lo) / kHistogramBins;
    EXPECT_NEAR(mass, 1.0, 1e-9);
  }
}

}  // namespace armcmc::test
