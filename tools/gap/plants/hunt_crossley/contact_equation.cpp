#include "gap/plants/hunt_crossley/contact_equation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/gap/features.hpp"
#include "armcmc/gap/form_file.hpp"
#include "armcmc/gap/law_error.hpp"
#include "armcmc/gap/sensor_forms.hpp"
#include "armcmc/gap/smoothing.hpp"
#include "armcmc/gap/statistics.hpp"

namespace armcmc::gap {
namespace {

enum Base { kStiffness = 0, kDamping = 1, kExponent = 2, kNumBase = 3 };
constexpr double kMinContactShare = 0.02;      // of the samples, below which a law of contact cannot be fitted
constexpr Eigen::Index kMinContactRows = 400;  // ten samples a block
constexpr int kAccelerationExtra = 26;         // samples by which the window of a derivative is wider
constexpr double kPeakQuantile = 0.9995;

class ContactEquation final : public Equation {
 public:
  explicit ContactEquation(std::string plant) : plant_(std::move(plant)) {}

  [[nodiscard]] std::string plant() const override { return plant_; }
  std::string output_name() const override { return "force"; }
  std::string output_unit() const override { return "N"; }
  std::vector<std::string> columns() const override { return {"t", "x", "v", "f"}; }
  std::vector<std::string> smoothed_columns() const override { return {"x", "v"}; }
  std::string active_name() const override { return "contact"; }
  std::string passive_name() const override { return "free motion"; }

  Signals Prepare(const Recording& recording, int window) const override {
    Signals s = Smooth(recording, window);
    if (s.rows() < kMinContactRows)
      throw std::invalid_argument(recording.source + ": holds " + std::to_string(s.rows()) + " samples; at least " +
                                  std::to_string(kMinContactRows) + " are needed to judge a model");
    // Without contact the law says nothing, but what acts in free motion can still be told apart.
    s.law_seen = s.active.mean() >= kMinContactShare;
    const Vector all = Vector::Ones(s.rows());
    const Vector& weight = s.law_seen ? s.active : all;
    s.scale[static_cast<std::size_t>(Role::kPosition)] = RootMeanSquare(s.at(Role::kPosition), weight);
    s.scale[static_cast<std::size_t>(Role::kVelocity)] = RootMeanSquare(s.at(Role::kVelocity));
    s.scale[static_cast<std::size_t>(Role::kAcceleration)] = RootMeanSquare(s.at(Role::kAcceleration));
    s.output_scale = RootMeanSquare(s.output, weight);
    s.output_peak = Quantile(s.law_seen ? s.output : Vector(s.output.cwiseAbs()), kPeakQuantile);
    if (!Moves(recording.Column("x")) || !Moves(recording.Column("v")))
      throw std::invalid_argument(recording.source + ": x or v does not move: a law of both cannot be identified");
    if (!(s.output_scale > 0.0) || !(s.output_peak > 0.0))
      throw std::invalid_argument(recording.source + ": f is not positive anywhere" +
                                  (s.law_seen ? " in contact: push must count as positive" : ": it does not change"));
    if (!Moves(s.output)) throw std::invalid_argument(recording.source + ": f does not change: nothing was measured");
    return s;
  }

  Signals PrepareLike(const Recording& recording, int window, const Signals& like) const override {
    Signals s = Smooth(recording, window);
    s.MeasureLike(like);
    return s;
  }

  std::vector<Coordinate> base(const Signals& s) const override {
    (void)s;
    return {{"K", "N/m^p", 1e-6, 100.0, 1.0, 2.0, 1.0, false},
            {"B", "N s/m^(p+1)", -20.0, 20.0, 0.0, 1.0, 1.0, false},
            {"p", "-", 0.3, 4.5, 1.5, 0.5, 1.0, false}};
  }

  Vector Start(const Signals& s) const override {
    (void)s;
    return Vector{{1.0, 0.05, 1.5}};
  }

  void Law(const Signals& s, const double* theta, const LawInput& input, Prediction* out) const override {
    const double k = theta[kStiffness], b = theta[kDamping], p = theta[kExponent];
    const double depth_scale = s.scale_of(Role::kPosition), speed_scale = s.scale_of(Role::kVelocity);
    const Vector& position = s.at(Role::kPosition);
    const Vector& velocity = s.at(Role::kVelocity);
    out->y = Vector::Zero(s.rows());
    out->elastic = Vector::Zero(s.rows());
    const bool shifts = !input.shift_slopes.empty(), gains = !input.gain_slopes.empty();
    Vector slope_by_position = Vector::Zero(shifts ? s.rows() : 0), elastic_slope = slope_by_position;
    Vector slope_by_gain = Vector::Zero(gains ? s.rows() : 0);
    const bool remembered = out->elastic_jacobian.cols() > 0;
    const std::shared_ptr<const Depths> inside =
        input.shift.size() > 0 ? std::make_shared<const Depths>(Vector(position - input.shift), depth_scale)
                               : depths_.Of(position, depth_scale);
    const Vector powers = s.output_scale * Exp(p * inside->log_u);
    for (std::size_t j = 0; j < inside->rows.size(); ++j) {
      const Eigen::Index i = inside->rows[j];
      const double log_u = inside->log_u[static_cast<Eigen::Index>(j)];
      const double power = powers[static_cast<Eigen::Index>(j)];
      const double rate = velocity[i] / speed_scale;
      const double gain = input.gain.size() > 0 ? input.gain[i] : 1.0;
      const double elastic = power * k * gain;
      const double force = elastic + power * b * rate;
      out->y[i] = force;
      out->elastic[i] = elastic;
      out->jacobian(i, kStiffness) = power * gain;
      out->jacobian(i, kDamping) = power * rate;
      out->jacobian(i, kExponent) = force * log_u;
      if (remembered) {
        out->elastic_jacobian(i, kStiffness) = power * gain;
        out->elastic_jacobian(i, kExponent) = elastic * log_u;
      }
      if (shifts) {
        const double per_position = p / (inside->u[static_cast<Eigen::Index>(j)] * depth_scale);
        slope_by_position[i] = force * per_position;
        elastic_slope[i] = elastic * per_position;
      }
      if (gains) slope_by_gain[i] = power * k;
    }
    for (const LawInput::Slope& slope : input.shift_slopes) {
      out->jacobian.col(slope.coordinate) -= slope_by_position.cwiseProduct(slope.rows);
      if (remembered) out->elastic_jacobian.col(slope.coordinate) -= elastic_slope.cwiseProduct(slope.rows);
    }
    for (const LawInput::Slope& slope : input.gain_slopes) {
      out->jacobian.col(slope.coordinate) += slope_by_gain.cwiseProduct(slope.rows);
      if (remembered) out->elastic_jacobian.col(slope.coordinate) += slope_by_gain.cwiseProduct(slope.rows);
    }
  }

  std::vector<ParameterEstimate> Report(const Signals& s, const Vector& theta,
                                        const Matrix& covariance) const override {
    const double force = s.output_scale, depth = s.scale_of(Role::kPosition), speed = s.scale_of(Role::kVelocity);
    const double p = theta[kExponent];
    const double stiffness = force * theta[kStiffness] * std::pow(depth, -p);
    const double damping = force * theta[kDamping] * std::pow(depth, -p) / speed;
    Matrix slopes = Matrix::Zero(3, 3);
    slopes(0, kStiffness) = stiffness / theta[kStiffness];
    slopes(0, kExponent) = -stiffness * std::log(depth);
    slopes(1, kDamping) = force * std::pow(depth, -p) / speed;
    slopes(1, kExponent) = -damping * std::log(depth);
    slopes(2, kExponent) = 1.0;
    const Matrix reported = slopes * covariance.topLeftCorner(3, 3) * slopes.transpose();
    const auto sd = [&](int i) { return std::sqrt(std::max(reported(i, i), 0.0)); };
    return {{"K", "N/m^p", stiffness, sd(0)}, {"B", "N s/m^(p+1)", damping, sd(1)}, {"p", "-", p, sd(2)}};
  }

  std::vector<EffectForm> Catalogue(const Signals& s) const override {
    std::vector<EffectForm> forms = FormsFor("contact", s, {});
    constexpr int kPlaces = 5;
    if (std::optional<EffectForm> error = LawError(s, kPlaces)) forms.push_back(*std::move(error));
    forms.push_back(DeadZoneForm(s));
    return forms;
  }

  std::optional<EffectForm> LawError(const Signals& s, int places) const override {
    constexpr double kFast = 2.0;  // times the rms speed
    if (!s.law_seen) return std::nullopt;
    return LawErrorForm({Role::kPosition, 0.0, s.at(Role::kPosition).maxCoeff()},
                        {Role::kVelocity, 0.0, kFast * s.scale_of(Role::kVelocity), true}, places);
  }

  std::vector<FeatureGroup> Groups(const Signals& s, const Vector& predicted) const override;

  std::vector<PlotFeature> PlotFeatures(const Signals& s) const override {
    return {{"depth x, m", s.at(Role::kPosition), "x"},
            {"speed v, m/s", s.at(Role::kVelocity), "v"},
            {"acceleration, m/s^2", s.at(Role::kAcceleration), "a"},
            {"time, s", s.t, "t"}};
  }

 private:
  /// Rows where the law acts, with their depths u over the scale.
  struct Depths {
    Depths(const Vector& position, double scale) {
      for (Eigen::Index i = 0; i < position.size(); ++i)
        if (position[i] / scale > 0.0) rows.push_back(i);
      u = position(rows) / scale;
      log_u = u.array().log();
    }
    std::vector<Eigen::Index> rows;
    Vector u, log_u;
  };
  /// Those of the last positions asked for: fits ask for the same ones again and again. Threads may share it.
  class LastDepths {
   public:
    std::shared_ptr<const Depths> Of(const Vector& position, double scale) {
      const std::lock_guard lock(mutex_);
      if (depths_ && scale == scale_ && position.size() == position_.size() && position == position_) return depths_;
      position_ = position;
      scale_ = scale;
      depths_ = std::make_shared<const Depths>(position, scale);
      return depths_;
    }

   private:
    std::mutex mutex_;
    Vector position_;
    double scale_ = 0.0;
    std::shared_ptr<const Depths> depths_;
  };

  static Signals Smooth(const Recording& recording, int window) {
    Signals s;
    s.dt = recording.dt;
    s.t = recording.t;
    s.output = recording.Column("f");
    s.origin = s.t[0];
    s.duration = std::max(s.t[s.rows() - 1] - s.t[0], s.dt);
    const Vector& v = recording.Column("v");
    const Vector& x = recording.Column("x");
    s.at(Role::kPosition) = SavitzkyGolay(x, window, 0);
    AssignSide(s.output, LeftOfNoise(RootMeanSquare(x - s.at(Role::kPosition)), window), &s.at(Role::kPosition));
    s.at(Role::kVelocity) = SavitzkyGolay(v, window, 0);
    s.velocity_noise = RootMeanSquare(v - s.at(Role::kVelocity));
    s.smoothed_velocity_noise = LeftOfNoise(s.velocity_noise, window);
    const int wide = window < 5 ? window : window + kAccelerationExtra;
    s.at(Role::kAcceleration) = SavitzkyGolay(v, wide, 1) / s.dt;
    s.active = (s.at(Role::kPosition).array() > 0.0).cast<double>();
    return s;
  }

  std::string plant_;
  mutable LastDepths depths_;
};

// Hats over quantiles: where the data are, there are the knots.
std::vector<FeatureGroup> ContactEquation::Groups(const Signals& s, const Vector& predicted) const {
  const Vector& x = s.at(Role::kPosition);
  const Vector& v = s.at(Role::kVelocity);
  const Vector& a = s.at(Role::kAcceleration);
  const Vector all = Vector::Ones(s.rows());
  const Vector free = 1.0 - s.active.array();
  const Vector depth = x.cwiseMax(0.0);
  const Vector time = s.Elapsed();
  const Vector direction = Tanh(v / (0.05 * s.scale_of(Role::kVelocity)));
  const double samples = s.duration / s.dt;
  const std::vector<double> x_inside = Sorted(x, s.active), v_inside = Sorted(v, s.active);

  std::vector<FeatureGroup> groups;
  groups.push_back({"depth", JoinColumns(Gated(HatFunctions(x, QuantileKnots(x_inside, 8)), s.active), free)});
  groups.push_back({"speed", HatFunctions(v, QuantileKnots(v, all, 9))});
  groups.push_back({"speed in contact", Gated(HatFunctions(v, QuantileKnots(v_inside, 5)), s.active)});
  groups.push_back({"time", HatFunctions(time, EvenKnots(9))});
  groups.push_back({"time x force", Gated(HatFunctions(time, EvenKnots(4)), predicted)});
  groups.push_back({"acceleration", HatFunctions(a, QuantileKnots(a, all, 6))});
  groups.push_back({"direction of motion",
                    JoinColumns(Gated(HatFunctions(x, QuantileKnots(x_inside, 5)), direction.cwiseProduct(s.active)),
                                direction.cwiseProduct(free))});
  Matrix memory(s.rows(), 4);
  for (int i = 0; i < 4; ++i) memory.col(i) = depth - Leaky(depth, 30.0 * std::pow(samples / 300.0, i / 3.0));
  groups.push_back({"memory of the past", memory});
  Matrix reversals(s.rows(), 2);
  reversals.col(0) = Bristle(v, 0.025 * s.scale_of(Role::kPosition), s.dt);
  reversals.col(1) = Bristle(v, 0.1 * s.scale_of(Role::kPosition), s.dt);
  groups.push_back({"distance since reversal", reversals});
  const Vector rate = SavitzkyGolay(predicted, 3, 1);
  Matrix change(s.rows(), 3);
  change.col(0) = rate;
  change.col(1) = SavitzkyGolay(rate, 3, 1);
  change.col(2) = predicted - Leaky(predicted, 20.0);
  groups.push_back({"rate of force", change});
  groups.push_back({"force", Gated(HatFunctions(predicted, QuantileKnots(predicted, s.active, 6)), s.active)});
  groups.push_back({"depth x speed", Gated(Products(HatFunctions(x, QuantileKnots(x_inside, 4)),
                                                    HatFunctions(v, QuantileKnots(v_inside, 4))),
                                           s.active)});
  return groups;
}

}  // namespace

std::unique_ptr<Equation> MakeContactEquation(const std::string& plant) {
  return std::make_unique<ContactEquation>(plant);
}

}  // namespace armcmc::gap
