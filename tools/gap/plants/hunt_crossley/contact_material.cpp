// The material and its surface: memory, adhesion, where it begins, how stiff it is.

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

#include "armcmc/gap/features.hpp"
#include "armcmc/gap/smoothing.hpp"
#include "gap/plants/hunt_crossley/contact_forms.hpp"

namespace armcmc::gap {
namespace {

constexpr double kFastest = 15.0;  // samples: a branch that forgets sooner is a damping

/// Probability that the true speed is negative, given the smoothed one. It depends on nothing that is fitted, so that
/// the last is kept. Threads may share it.
class Retracting {
 public:
  Vector Of(const Signals& s) {
    const double spread = std::max(s.smoothed_velocity_noise, 1e-9 * s.scale_of(Role::kVelocity));
    const Vector& velocity = s.at(Role::kVelocity);
    const std::lock_guard lock(mutex_);
    if (spread == spread_ && velocity.size() == velocity_.size() && velocity == velocity_) return last_;
    spread_ = spread;
    velocity_ = velocity;
    last_ = velocity.unaryExpr([spread](double v) { return 0.5 * std::erfc(v / (std::sqrt(2.0) * spread)); });
    return last_;
  }

 private:
  std::mutex mutex_;
  double spread_ = 0.0;
  Vector velocity_, last_;
};

}  // namespace

void AddMaterial(const Signals& s, std::vector<EffectForm>* out) {
  const double force = s.output_scale, length = s.scale_of(Role::kPosition);
  const Coordinate stiffness = AmplitudeOf("stiffness", "N/m", force / length, true, 0.5, 20.0);
  const Coordinate tau = UpTo(ShapeOf("time_constant", "s", 1.0, kFastest * s.dt, 0.4 * s.duration));
  // What the branch remembers of the time before the recording: 1 it had relaxed, 0 it had seen nothing.
  const Coordinate start = UpTo({"start", "-", 0.0, 1.3, 1.0, 0.5, 1.0, false, true});
  EffectForm relaxation = FromCore("stress_relaxation", {stiffness, tau, start});
  relaxation.features = [relaxation](const Signals& in, const double* shape) -> Matrix {
    const Vector depth = in.at(Role::kPosition).cwiseMax(0.0);
    return relaxation.coordinates[0].unit_size *
           (depth - Leaky(depth, ShapeValue(relaxation, 0, shape) / in.dt, shape[1]));
  };
  relaxation.own_groups = {"memory of the past", "distance since reversal"};
  SetStarts(&relaxation, {6, 2});
  out->push_back(relaxation);

  EffectForm elastic = Reformulated(relaxation, "elastic", "f + share q, q' = (K x^p)' - q / time_constant",
                                    {AmplitudeOf("share", "-", 1.0, true, 0.5, 20.0), tau, start}, 1);
  elastic.slot = Slot::kMemory;
  elastic.filter = [elastic](const Signals& in, const Vector& series, int, const double* shape) -> Vector {
    return series - Leaky(series, ShapeValue(elastic, 0, shape) / in.dt, shape[1]);
  };
  SetStarts(&elastic, {6, 2});
  out->push_back(elastic);

  EffectForm two =
      Reformulated(relaxation, "two_time_constants", "f + share1 q1 + share2 q2, qi' = (K x^p)' - qi / taui",
                   {AmplitudeOf("share_fast", "-", 1.0, true, 0.5, 20.0),
                    AmplitudeOf("share_slow", "-", 1.0, true, 0.5, 20.0),
                    tau,
                    {"ratio", "-", std::log(2.0), std::log(20.0), std::log(6.0), 0.6, 1.0, true}},
                   2);
  two.slot = Slot::kMemory;
  two.filter = [two](const Signals& in, const Vector& series, int amplitude, const double* shape) -> Vector {
    // The slow one is the coordinate, and at its bound the branch is another effect: it must not hide behind a fast one
    // that takes no share.
    const double slow = ShapeValue(two, 0, shape);
    // Nor must a fast one be faster than a branch alone may be: it would be a damping.
    const double tau_s = amplitude == 0 ? std::max(slow / ShapeValue(two, 1, shape), kFastest * in.dt) : slow;
    return series - Leaky(series, tau_s / in.dt);
  };
  SetStarts(&two, {4, 1});
  out->push_back(two);

  const Coordinate tension = AmplitudeOf("force", "N", force, true, 0.3);
  const Coordinate reach = UpTo(ShapeOf("distance", "m", length, 0.015, 1.2));
  EffectForm adhesion = FromCore("adhesion", {tension, reach});
  const auto retracting = std::make_shared<Retracting>();
  adhesion.features = [adhesion, retracting](const Signals& in, const double* shape) -> Matrix {
    const Eigen::ArrayXd x = in.at(Role::kPosition).array();
    const Eigen::ArrayXd pull = in.output_scale * Exp(-x.max(0.0) / ShapeValue(adhesion, 0, shape));
    return (-pull * retracting->Of(in).array() * (x >= 0.0).cast<double>()).matrix();
  };
  adhesion.own_groups = {"direction of motion"};
  SetStarts(&adhesion, {4});
  out->push_back(adhesion);
  // The neck that holds on outside the surface until it breaks.
  EffectForm neck = Reformulated(
      adhesion, "pull_off", "f - force n(x) while retracting, n = exp(-x / distance) inside, 1 + x / distance outside",
      {tension, reach}, 1);
  neck.features = [neck](const Signals& in, const double* shape) -> Matrix {
    const Vector& x = in.at(Role::kPosition);
    const Vector& v = in.at(Role::kVelocity);
    const double d = ShapeValue(neck, 0, shape);
    Vector column = Vector::Zero(in.rows());
    bool bonded = false;
    for (Eigen::Index i = 0; i < in.rows(); ++i) {
      if (x[i] >= 0.0) bonded = true;
      if (x[i] <= -d) bonded = false;
      if (bonded && v[i] < 0.0) column[i] = -in.output_scale * (x[i] >= 0.0 ? std::exp(-x[i] / d) : 1.0 + x[i] / d);
    }
    return column;
  };
  SetStarts(&neck, {4});
  out->push_back(neck);
  EffectForm tail =
      Reformulated(adhesion, "power_law", "f - force / (1 + x / distance)^2 for v < 0, x >= 0", {tension, reach}, 1);
  tail.features = [tail, retracting](const Signals& in, const double* shape) -> Matrix {
    const Eigen::ArrayXd x = in.at(Role::kPosition).array();
    const Eigen::ArrayXd pull = in.output_scale / (1.0 + x.max(0.0) / ShapeValue(tail, 0, shape)).square();
    return (-pull * retracting->Of(in).array() * (x >= 0.0).cast<double>()).matrix();
  };
  SetStarts(&tail, {3});
  out->push_back(tail);
}

void AddSurfaceAndStiffness(const Signals& s, std::vector<EffectForm>* out) {
  EffectForm offset =
      FromCore("contact_offset", {{"distance", "m", -0.8, 0.8, 0.0, 0.2, s.scale_of(Role::kPosition), false}});
  offset.slot = Slot::kInputMap;
  offset.features = [](const Signals& in, const double*) -> Matrix {
    return Vector::Constant(in.rows(), in.scale_of(Role::kPosition));
  };
  offset.linear = false;
  offset.starts = {{-0.3}, {-0.1}, {-0.02}, {0.02}, {0.1}, {0.3}};
  out->push_back(offset);

  EffectForm drift = FromCore("stiffness_drift", {{"rate", "1/s", -0.95, 3.0, 0.0, 0.3, 1.0 / s.duration, false}});
  drift.slot = Slot::kParameter;
  drift.features = [](const Signals& in, const double*) -> Matrix { return in.Elapsed(); };
  drift.own_groups = {"time x force"};
  drift.plain_error = "a stiffness that drifts";
  SetStarts(&drift, {});
  out->push_back(drift);
  EffectForm exponential = Reformulated(
      drift, "exponential", "K (1 + share (1 - exp(-t / time_constant))) in place of K",
      {{"share", "-", -0.95, 3.0, 0.0, 0.3, 1.0, false}, DownTo(ShapeOf("time_constant", "s", s.duration, 0.05, 1.5))},
      1);
  exponential.features = [exponential](const Signals& in, const double* shape) -> Matrix {
    const double tau = ShapeValue(exponential, 0, shape);
    return (1.0 - Exp((in.origin - in.t.array()) / tau).array()).matrix();
  };
  SetStarts(&exponential, {3});
  out->push_back(exponential);
}

}  // namespace armcmc::gap
