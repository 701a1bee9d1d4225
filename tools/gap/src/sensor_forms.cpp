#include "armcmc/gap/sensor_forms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "armcmc/gap/smoothing.hpp"

namespace armcmc::gap {
namespace {

// A latency is sought up to this many samples, and up to this multiple of the time in which the motion changes. A
// longer delay is another phase of the motion; a lag may last half a period, as in the effects of every plant. A
// shorter one than the shortest is none: smoothing noisy inputs moves a prediction by as much.
constexpr double kShortestSamples = 0.1;
constexpr double kLongestSamples = 50.0, kLongestDelay = 0.3, kLongestLag = std::numbers::pi;
constexpr double kUnitSamples = 10.0;  // of the recording that the catalogue is scaled to: a latency of one

/// Low pass tau g' + g = f, exact for f linear between samples, started settled.
Vector LowPass(const Vector& f, double tau_samples) {
  const double ratio = std::max(tau_samples, 1e-6);
  const double keep = std::exp(-1.0 / ratio);
  const double ramp = (1.0 - keep) * ratio;
  Vector g(f.size());
  g[0] = f[0];
  for (Eigen::Index i = 1; i < f.size(); ++i) g[i] = keep * g[i - 1] + (1.0 - ramp) * f[i] + (ramp - keep) * f[i - 1];
  return g;
}

/// f(t - lag), linear between samples, the first value before the start.
Vector Delayed(const Vector& f, double lag_samples) {
  const auto whole = static_cast<Eigen::Index>(std::floor(lag_samples));
  const double part = lag_samples - static_cast<double>(whole);
  Vector g(f.size());
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    const double near = f[std::max<Eigen::Index>(i - whole, 0)], far = f[std::max<Eigen::Index>(i - whole - 1, 0)];
    g[i] = near + part * (far - near);
  }
  return g;
}

/// Applies a linear filter to the prediction and to every wanted column that it has so far; the filter's own column is
/// the difference quotient by its coordinate.
template <class Filter>
void ApplyFilter(const Filter& filter, double coordinate, int own, Prediction* out) {
  constexpr double kStep = 1e-4;
  const Vector before = out->y;
  out->y = filter(before, coordinate);
  for (Eigen::Index c = 0; c < out->jacobian.cols(); ++c)
    if (out->wanted.Has(static_cast<int>(c)) && !out->jacobian.col(c).isZero(0.0))
      out->jacobian.col(c) = filter(out->jacobian.col(c), coordinate);
  if (out->wanted.Has(own)) out->jacobian.col(own) = (filter(before, coordinate + kStep) - out->y) / kStep;
}

EffectForm Latency(const char* effect, const char* formula, Slot slot, const Signals& signals, const char* parameter,
                   double longest_multiple) {
  const double motion_s = signals.scale_of(Role::kVelocity) / signals.scale_of(Role::kAcceleration);
  const double longest = std::max(kLongestSamples, longest_multiple * motion_s / signals.dt);
  EffectForm form;
  form.effect = effect;
  form.family = "latency";
  form.formula = formula;
  form.slot = slot;
  form.num_amplitudes = 0;
  form.linear = false;
  form.coordinates = {
      {parameter, "s", kShortestSamples / kUnitSamples, longest / kUnitSamples, 0.0, 0.7, kUnitSamples * signals.dt}};
  form.coordinates.front().other_below = true;
  double start = 0.05;
  while (start < longest / kUnitSamples) {
    form.starts.push_back({start});
    start *= 2.5;
  }
  return form;
}

}  // namespace

std::vector<EffectForm> LatencyForms(const Signals& signals) {
  // Other recordings may be sampled at another rate.
  const auto samples_of_one = [dt = signals.dt](const Signals& in) { return kUnitSamples * (dt / in.dt); };
  EffectForm delay = Latency("sensor_delay", "f(t - time)", Slot::kDelay, signals, "time", kLongestDelay);
  delay.sense = [samples_of_one](const Signals& in, const double* c, int own, Prediction* out) {
    ApplyFilter([one = samples_of_one(in)](const Vector& f, double at) { return Delayed(f, one * at); }, c[0], own,
                out);
  };
  EffectForm lag =
      Latency("sensor_lag", "g, time_constant g' + g = f", Slot::kLag, signals, "time_constant", kLongestLag);
  lag.sense = [samples_of_one](const Signals& in, const double* c, int own, Prediction* out) {
    ApplyFilter([one = samples_of_one(in)](const Vector& f, double at) { return LowPass(f, one * at); }, c[0], own,
                out);
  };
  EffectForm second = lag;
  second.variant = "second_order";
  second.formula = "g, (time_constant d/dt + 1)^2 g = f";
  second.sense = [samples_of_one](const Signals& in, const double* c, int own, Prediction* out) {
    ApplyFilter(
        [one = samples_of_one(in)](const Vector& f, double at) { return LowPass(LowPass(f, one * at), one * at); },
        c[0], own, out);
  };
  return {delay, lag, second};
}

std::vector<EffectForm> SaturationForms(const Signals& signals) {
  EffectForm clip;
  clip.effect = "sensor_saturation";
  clip.family = "saturation";
  clip.formula = "min(f, limit)";
  clip.slot = Slot::kStatics;
  clip.num_amplitudes = 0;
  clip.linear = false;
  clip.coordinates = {{"limit", "N", 0.05, 1.05, 0.8, 0.3, signals.output_peak, false}};
  double start = 0.985;
  while (start > 0.2) {
    clip.starts.push_back({start});
    start *= 0.91;
  }
  clip.own_groups = {"force"};
  const double peak = signals.output_peak;
  clip.sense = [peak](const Signals&, const double* c, int own, Prediction* out) {
    const double limit = c[0] * peak;
    for (Eigen::Index i = 0; i < out->y.size(); ++i)
      if (out->y[i] > limit) {
        out->y[i] = limit;
        out->jacobian.row(i).setZero();
        out->jacobian(i, own) = peak;
      }
  };
  EffectForm soft = clip;
  soft.variant = "soft";
  soft.formula = "f / (1 + (f / limit)^8)^(1/8)";
  soft.coordinates[0].upper = 1.6;
  soft.starts = {{0.45}, {0.75}, {0.95}, {1.2}};
  soft.sense = [peak](const Signals&, const double* c, int own, Prediction* out) {
    const double limit = c[0] * peak;
    for (Eigen::Index i = 0; i < out->y.size(); ++i) {
      const double f = out->y[i];
      if (!(f > 0.0)) continue;
      const double square = f / limit * (f / limit), fourth = square * square, ratio = fourth * fourth;
      const double damp = 1.0 / std::sqrt(std::sqrt(std::sqrt(1.0 + ratio)));
      out->y[i] *= damp;
      out->jacobian.row(i) *= damp / (1.0 + ratio);
      out->jacobian(i, own) = f / limit * damp * ratio / (1.0 + ratio) * peak;
    }
  };
  std::vector<EffectForm> forms = {clip, soft};
  // A sensor that clips pulls as it clips pushes. Where there are none the two formulas are one.
  if (signals.output.minCoeff() < -0.1 * peak) {
    EffectForm both = clip;
    both.variant = "both_ways";
    both.formula = "min(max(f, -limit), limit)";
    both.sense = [peak](const Signals&, const double* c, int own, Prediction* out) {
      const double limit = c[0] * peak;
      for (Eigen::Index i = 0; i < out->y.size(); ++i)
        if (std::abs(out->y[i]) > limit) {
          const double side = std::copysign(1.0, out->y[i]);
          out->y[i] = side * limit;
          out->jacobian.row(i).setZero();
          out->jacobian(i, own) = side * peak;
        }
    };
    forms.push_back(both);
  }
  return forms;
}

EffectForm DeadZoneForm(const Signals& signals) {
  EffectForm form;
  form.listed = false;
  form.effect = "a dead zone of the sensor";
  form.family = "dead zone";
  form.formula = "sign(f) max(|f| - width, 0)";
  form.slot = Slot::kStatics;
  form.num_amplitudes = 0;
  form.linear = false;
  form.coordinates = {{"width", "N", 0.0, 2.0, 0.0, 0.2, signals.output_scale, false}};
  form.starts = {{0.003}, {0.01}, {0.03}, {0.1}, {0.3}, {0.8}};
  const double scale = signals.output_scale;
  form.sense = [scale](const Signals&, const double* c, int own, Prediction* out) {
    const double width = c[0] * scale;
    for (Eigen::Index i = 0; i < out->y.size(); ++i) {
      const double f = out->y[i];
      if (std::abs(f) <= width) {
        out->y[i] = 0.0;
        out->jacobian.row(i).setZero();
      } else {
        out->y[i] = std::copysign(std::abs(f) - width, f);
        out->jacobian(i, own) = -std::copysign(scale, f);
      }
    }
  };
  return form;
}

}  // namespace armcmc::gap
