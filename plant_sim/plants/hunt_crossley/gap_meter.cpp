#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "armcmc/plant_sim/effects/effect_chain.hpp"
#include "armcmc/plant_sim/effects/gap_meter.hpp"
#include "hunt_crossley/effects.hpp"

namespace armcmc::plant_sim {
namespace {

/// Least squares of K, B, p, each with a constant correction d of its schedule:
///   min_d sum (y - x^(p + d3) (K + d1 + (B + d2) v))^2
/// by Gauss-Newton with Levenberg's damping.
class ContactGapMeter final : public GapMeter {
 public:
  explicit ContactGapMeter(const Scenario& scenario)
      : plant_(scenario.MakePlant()),
        timing_{scenario.sample_interval_s, scenario.duration_s},
        noise_sd_(NoiseSd(scenario.noise.back())) {
    if (!(noise_sd_ > 0.0))
      throw std::invalid_argument("the scenario has no noise on " + scenario.family->output.name +
                                  ": a gap ratio is undefined");
    const long long last = std::min(scenario.last_sample(scenario.num_packs()), kMaxGapSamples);
    samples_.resize(static_cast<std::size_t>(last) + 1);
    for (PlantSample& sample : samples_) {
      plant_->Advance(&sample);
      if (!std::isfinite(sample.output)) throw std::invalid_argument("the plant leaves the finite range");
    }
    MeasureNoise(scenario.noise.back());
    MeasureScales();
  }

  [[nodiscard]] double GapRatio(const std::vector<HiddenEffect>& effects) const override {
    EffectChain chain(effects, timing_, plant_.get());
    double free_sq = 0.0;
    std::vector<Row> rows;
    rows.reserve(samples_.size());
    for (const PlantSample& sample : samples_) {
      const double seen = chain.Apply(sample).output;
      const double x = sample.inputs[0];
      if (x > 0.0)
        rows.push_back({plant_->Truth(0, sample.t_s), std::log(x), sample.inputs[1], seen});
      else
        free_sq += seen * seen;
    }
    const double sum = free_sq + Refit(rows);
    return std::sqrt(sum / static_cast<double>(samples_.size())) / noise_sd_;
  }

  [[nodiscard]] const EffectScales& scales() const override { return scales_; }

 private:
  struct Row {
    Theta theta;
    double log_x, v, seen;
  };
  struct Normal {
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    double sum_sq = 0.0;
  };

  static Normal Linearize(const std::vector<Row>& rows, const Eigen::Vector3d& d) {
    Normal normal;
    for (const Row& row : rows) {
      const double power = std::exp((row.theta[2] + d[2]) * row.log_x);
      const double law = row.theta[0] + d[0] + (row.theta[1] + d[1]) * row.v;
      const Eigen::Vector3d slope(power, power * row.v, power * law * row.log_x);
      const double residual = row.seen - power * law;
      normal.h += slope * slope.transpose();
      normal.g += slope * residual;
      normal.sum_sq += residual * residual;
    }
    return normal;
  }

  /// @return the sum of squares that stays.
  static double Refit(const std::vector<Row>& rows) {
    constexpr int kMaxSteps = 60;
    Eigen::Vector3d d = Eigen::Vector3d::Zero();
    Normal now = Linearize(rows, d);
    double damping = 1e-9;
    for (int i = 0; i < kMaxSteps; ++i) {
      Eigen::Matrix3d h = now.h;
      h.diagonal() *= 1.0 + damping;
      h.diagonal().array() += 1e-300;
      const Eigen::Vector3d tried = d + h.ldlt().solve(now.g);
      const Normal next = Linearize(rows, tried);
      if (!(next.sum_sq <= now.sum_sq)) {
        damping = std::max(10.0 * damping, 1e-6);
        if (damping > 1e6) break;
        continue;
      }
      const bool settled = now.sum_sq - next.sum_sq <= 1e-7 * now.sum_sq;
      d = tried;
      now = next;
      damping *= 0.1;
      if (settled) break;
    }
    return now.sum_sq;
  }

  /// A noise that grows with the force counts with its rms over the run.
  void MeasureNoise(const NoiseLaw& law) {
    if (!(law.growth > 0.0)) return;
    double sum = 0.0;
    for (const PlantSample& sample : samples_) {
      const double factor = 1.0 + law.growth * std::abs(sample.output) / law.reference;
      sum += factor * factor;
    }
    noise_sd_ *= std::sqrt(sum / static_cast<double>(samples_.size()));
  }

  void MeasureScales() {
    double force_sq = 0.0, speed_sq = 0.0, accel_sq = 0.0, peak = 0.0, depth = 0.0;
    std::size_t contact = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const PlantSample& sample = samples_[i];
      speed_sq += sample.inputs[1] * sample.inputs[1];
      if (i > 0) {
        const double accel = (sample.inputs[1] - samples_[i - 1].inputs[1]) / timing_.dt_s;
        accel_sq += accel * accel;
      }
      if (sample.mode != 0) continue;
      force_sq += sample.output * sample.output;
      peak = std::max(peak, std::abs(sample.output));
      depth = std::max(depth, sample.inputs[0]);
      ++contact;
    }
    const auto n = static_cast<double>(samples_.size());
    double force = std::sqrt(force_sq / static_cast<double>(std::max<std::size_t>(contact, 1)));
    if (!(force > 0.0)) {
      // In the air there is no force but the noise, and no depth but the way.
      force = peak = noise_sd_;
      for (const PlantSample& sample : samples_) depth = std::max(depth, std::abs(sample.inputs[0]));
    }
    const double speed = std::sqrt(speed_sq / n), accel = std::sqrt(accel_sq / n);
    if (!(speed > 0.0)) throw std::invalid_argument("effects can be hidden only in a run that moves");
    scales_ = {1.0,           timing_.duration_s,      force,         peak,         depth, speed,
               force / speed, force / (speed * speed), force / accel, force / depth};
  }

  std::unique_ptr<Plant> plant_;
  EffectTiming timing_;
  double noise_sd_;
  std::vector<PlantSample> samples_;
  EffectScales scales_{};
};

}  // namespace

std::unique_ptr<GapMeter> MakeContactGapMeter(const Scenario& scenario) {
  return std::make_unique<ContactGapMeter>(scenario);
}

}  // namespace armcmc::plant_sim
