#include "tools/gap/report_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace armcmc::gap::test {
namespace {

constexpr double kDt = 1e-3, kNoise = 0.02;
constexpr int kSamples = 20000;
constexpr double kDiagnosisEnd = 14.0;

/// One sample of a finger that presses on a soft object and lets go.
struct State {
  double t, x, v, force, slope;  // slope: dF/dt
};

State StateAt(double t) {
  const auto depth = [](double s) { return 0.6 + std::sin(s) + 0.15 * std::sin(7.3 * s); };
  const auto force = [&](double s) {
    const double x = std::max(depth(s), 0.0), v = std::cos(s) + 1.095 * std::cos(7.3 * s);
    return std::max(0.0, std::pow(x, 1.7) * (4.0 + 0.6 * v));
  };
  return {t, depth(t), std::cos(t) + 1.095 * std::cos(7.3 * t), force(t), (force(t + 1e-4) - force(t - 1e-4)) / 2e-4};
}

/// What the base model lacks.
double Missing(Verdict verdict, const State& s) {
  switch (verdict) {
    case Verdict::kNamed: return 0.08 * std::tanh(s.v / 0.02);
    case Verdict::kAmbiguous: return -0.009 * s.slope;
    case Verdict::kUnnamed: return s.x > 0.3 ? 0.09 * std::sin(9.0 * s.x * s.x) * (s.v < 0.0 ? 1.0 : 0.35) : 0.0;
    case Verdict::kNone: break;
  }
  return 0.0;
}

struct Samples {
  std::vector<State> state;
  std::vector<double> missing, noise;
};

Samples MakeSamples(Verdict verdict) {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal(0.0, kNoise);
  Samples out;
  for (int i = 0; i < kSamples; ++i) {
    out.state.push_back(StateAt(i * kDt));
    out.missing.push_back(Missing(verdict, out.state.back()));
    out.noise.push_back(normal(generator));
  }
  return out;
}

/// Mean of values in bins of a feature, with 95 % band.
Curve Binned(const Samples& s, const std::function<double(const State&)>& feature,
             const std::function<double(std::size_t)>& value) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const State& state : s.state) low = std::min(low, feature(state)), high = std::max(high, feature(state));
  constexpr std::size_t kBins = 40;
  std::vector<double> n(kBins), sum(kBins), sum2(kBins);
  for (std::size_t i = 0; i < s.state.size(); ++i) {
    const double place = (feature(s.state[i]) - low) / (high - low) * static_cast<double>(kBins);
    const std::size_t bin = std::min(kBins - 1, static_cast<std::size_t>(place));
    n[bin] += 1.0, sum[bin] += value(i), sum2[bin] += value(i) * value(i);
  }
  Curve curve;
  for (std::size_t b = 0; b < kBins; ++b) {
    if (n[b] < 20.0) continue;
    const double mean = sum[b] / n[b], sd = std::sqrt(std::max(0.0, sum2[b] / n[b] - mean * mean));
    curve.x.push_back(low + (static_cast<double>(b) + 0.5) * (high - low) / static_cast<double>(kBins));
    curve.y.push_back(mean);
    curve.low.push_back(mean - 1.96 * sd / std::sqrt(n[b] / 10.0));
    curve.high.push_back(mean + 1.96 * sd / std::sqrt(n[b] / 10.0));
  }
  return curve;
}

MapFigure MakeMap(const Samples& s) {
  constexpr std::size_t kX = 28, kV = 20;
  MapFigure map{"depth x, m", "speed v, m/s", "times the noise", {}, {}, {}};
  for (std::size_t i = 0; i <= kX; ++i) map.x_edges.push_back(-0.6 + 2.4 * static_cast<double>(i) / kX);
  for (std::size_t j = 0; j <= kV; ++j) map.y_edges.push_back(-2.2 + 4.4 * static_cast<double>(j) / kV);
  std::vector<double> n(kX * kV), sum(kX * kV);
  for (std::size_t k = 0; k < s.state.size(); ++k) {
    const double i = (s.state[k].x + 0.6) / 2.4 * kX, j = (s.state[k].v + 2.2) / 4.4 * kV;
    if (i < 0.0 || i >= kX || j < 0.0 || j >= kV) continue;
    const std::size_t cell = static_cast<std::size_t>(j) * kX + static_cast<std::size_t>(i);
    const double error = (s.missing[k] + s.noise[k]) / kNoise;
    n[cell] += 1.0, sum[cell] += error * error;
  }
  for (std::size_t c = 0; c < n.size(); ++c)
    map.value.push_back(n[c] < 5.0 ? std::nan("") : std::max(0.0, sum[c] / n[c] - 1.0));
  return map;
}

Curve Spectrum(double excess, double corner_hz) {
  std::mt19937 generator(11);
  std::gamma_distribution<double> ripple(8.0, 1.0 / 8.0);
  Curve curve;
  for (double f = 0.25; f <= 500.0; f *= 1.06) {
    curve.x.push_back(f);
    curve.y.push_back((1.0 + excess / (1.0 + (f / corner_hz) * (f / corner_hz))) * ripple(generator));
  }
  return curve;
}

Figures MakeFigures(Verdict verdict) {
  const Samples s = MakeSamples(verdict);
  const bool has_after = verdict == Verdict::kNamed || verdict == Verdict::kAmbiguous;
  Figures f;
  f.output_title = "force, N";
  f.diagnosis_end_s = kDiagnosisEnd;
  for (std::size_t i = 0; i < s.state.size(); ++i) {
    const double t = s.state[i].t, truth = s.state[i].force + s.missing[i];
    const auto add = [&](Curve* curve, double y) { curve->x.push_back(t), curve->y.push_back(y); };
    add(&f.measured, truth + s.noise[i]);
    add(&f.predicted_before, s.state[i].force);
    add(&f.residual_before, s.missing[i] + s.noise[i]);
    if (!has_after) continue;
    add(&f.predicted_after, truth);
    add(&f.residual_after, s.noise[i]);
  }
  const std::vector<std::pair<std::string, std::function<double(const State&)>>> features = {
      {"speed v, m/s", [](const State& x) { return x.v; }},
      {"depth x, m", [](const State& x) { return x.x; }},
      {"rate of force dF/dt, N/s", [](const State& x) { return x.slope; }},
      {"time, s", [](const State& x) { return x.t; }}};
  for (const auto& [title, feature] : features) {
    FeatureFigure figure{title, Binned(s, feature, [&](std::size_t i) { return s.missing[i] + s.noise[i]; }), {}, {}};
    if (has_after) {
      figure.after = Binned(s, feature, [&](std::size_t i) { return s.noise[i]; });
      figure.effect = Binned(s, feature, [&](std::size_t i) { return s.missing[i]; });
      figure.effect.low.clear(), figure.effect.high.clear();
    }
    f.features.push_back(figure);
  }
  f.spectrum_before = Spectrum(verdict == Verdict::kNone ? 0.0 : 60.0, 4.0);
  if (has_after) f.spectrum_after = Spectrum(0.0, 1.0);
  f.where = MakeMap(s);
  return f;
}

Result Common(Verdict verdict) {
  Result r;
  r.version = "0.1.0";
  r.model = "hunt_crossley";
  r.data_file = "/data/press-and-release.csv";
  r.data_sha256 = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08";
  r.seed = 1;
  r.rows = kSamples;
  r.dt = kDt;
  r.notes = {"Column v is derived from x by a smoothing spline.",
             "Rows 11201 to 11203 repeat a time and were skipped."};
  r.verdict = verdict;
  r.aliases = {"force_bias and a constant tilt of the arm: the same signal in this recording"};
  r.gap.unit = "N";
  r.gap.noise_floor = kNoise;
  r.gap.before = {0.0801, 0.0693, 0.142, 0.431, 212.0};
  r.gap.after = {0.0203, 0.0162, 0.0524, 0.949, 1.12};
  r.gap.modes = {{"contact", 4012, 0.0812, 0.0204}, {"free", 1988, 0.0779, 0.0201}};
  r.gap.gap_ratio = 3.87;
  r.parameters = {{{"K", "N/m^p", 4.212, 0.021}, {"K", "N/m^p", 4.003, 0.008}},
                  {{"B", "N s/m^(1+p)", 0.871, 0.013}, {"B", "N s/m^(1+p)", 0.602, 0.005}},
                  {{"p", "", 1.662, 0.006}, {"p", "", 1.699, 0.002}}};
  r.budget = {3.186, 3.441, 100.0, true, true};
  r.seconds = {{"read", 0.04}, {"search", 1.92}, {"verify", 0.31}};
  r.figures = MakeFigures(verdict);
  return r;
}

void MakeNamed(Result* r) {
  r->sentence = "The model lacks dry friction: a Coulomb force of 0.080 N against the motion.";
  r->probability_none = 1e-9;
  r->probability_unnamed = 0.006;
  r->effects = {{"coulomb_friction",
                 "dry friction",
                 0.991,
                 {{"force", "N", 0.0801, 0.0007}, {"speed", "m/s", 0.02, 0.0}},
                 {},
                 false,
                 false}};
  r->candidates = {{{"coulomb_friction"}, 48211.3, 9120.4, 0.991, 0.996},
                   {{"presliding_friction"}, 48160.9, 9071.2, 0.002, 0.981},
                   {{"coulomb_friction", "force_bias"}, 48206.8, 9119.9, 0.001, 0.996},
                   {{"viscous_friction"}, 44102.7, 5108.8, 0.0, 0.612},
                   {{"asymmetric_friction from 4.25 s"}, 43180.0, 4410.1, 0.0, 0.52},
                   {{"inertia"}, 39302.2, 310.5, 0.0, 0.041},
                   {{}, 38990.6, 0.0, 1e-9, 0.0}};
  r->where = {{"speed v", "v near 0, both signs", 0.91, 14.2, 1e-12},
              {"direction of motion", "in contact, v < 0", 0.62, 9.1, 1e-9},
              {"time", "", 0.05, 0.004, 0.21}};
  r->gap.closed_fraction = 0.9951, r->gap.closed_low = 0.9893, r->gap.closed_high = 0.9988;
  r->gap.control_effects = "viscous_friction", r->gap.control_closed_fraction = 0.587;
  r->model_file = "model.toml";
}

void MakeAmbiguous(Result* r) {
  r->sentence = "The force sensor answers late: by a pure delay or by a first-order lag of about 9 ms.";
  r->probability_none = 1e-6;
  r->probability_unnamed = 0.021;
  r->effects = {{"sensor_lag", "latency", 0.541, {{"time_constant", "s", 0.00912, 0.00021}}, {}, false, true}};
  r->ambiguous_set = {{"sensor_lag"}, {"sensor_delay"}};
  r->separate_by = {
      "Tap the surface five times in a second, 2 cm deep: a delay leaves the shape of a tap alone, a lag rounds it.",
      "separate.toml", 777.0};
  r->candidates = {{{"sensor_lag"}, 47011.4, 8120.1, 0.541, 0.991},
                   {{"sensor_delay"}, 47011.2, 8119.8, 0.438, 0.990},
                   {{"stress_relaxation"}, 43100.7, 4110.3, 0.0, 0.533},
                   {{}, 38990.6, 0.0, 1e-6, 0.0}};
  r->where = {{"rate of force dF/dt", "in contact", 0.97, 8.1, 1e-12},
              {"speed v", "in contact, v > 0", 0.71, 3.0, 2e-6}};
  r->gap.closed_fraction = 0.991, r->gap.closed_low = 0.981, r->gap.closed_high = 0.997;
  r->gap.control_effects = "sensor_delay", r->gap.control_closed_fraction = 0.990;
  r->model_file = "model.toml";
}

void MakeUnnamed(Result* r) {
  r->sentence = "Something acts on the force in deep contact that no effect of the catalogue explains.";
  r->probability_none = 0.0004;
  r->probability_unnamed = 0.978;
  r->candidates = {{{"coulomb_friction"}, 39410.2, 402.0, 0.012, 0.21},
                   {{"adhesion", "stress_relaxation"}, 39390.1, 388.3, 0.008, 0.20},
                   {{}, 38990.6, 0.0, 0.0004, 0.0}};
  r->where = {{"depth x", "x > 0.3 m, v < 0", 0.88, 4.1, 1e-12}, {"memory of the past", "", 0.12, 0.03, 0.004}};
  r->sparse = {{"sin(9 x^2) [v < 0]", 0.0884, 0.74}, {"x |v|", -0.0101, 0.08}};
  r->gap.after = r->gap.before;
  r->gap.closed_fraction = r->gap.closed_low = r->gap.closed_high = 0.0;
  r->budget = {};
  for (ParameterChange& change : r->parameters) change.after = change.before;
}

void MakeNone(Result* r) {
  r->sentence = "The model explains these data down to the noise.";
  r->probability_none = 0.987;
  r->probability_unnamed = 0.004;
  r->candidates = {{{}, 48990.6, 0.0, 0.987, 0.0},
                   {{"viscous_friction"}, 48986.1, -1.3, 0.005, 0.002},
                   {{"force_drift"}, 48985.2, -2.0, 0.004, 0.001}};
  r->where = {{"speed v", "", 0.02, 0.0004, 0.34}};
  r->aliases.clear();
  r->gap.before = r->gap.after = {0.0201, 0.016, 0.0517, 0.951, 0.94};
  r->gap.gap_ratio = 0.04;
  r->gap.closed_fraction = r->gap.closed_low = r->gap.closed_high = std::nan("");
  r->gap.modes = {{"contact", 4012, 0.0202, 0.0202}, {"free", 1988, 0.02, 0.02}};
  for (ParameterChange& change : r->parameters) change.before = change.after;
}

}  // namespace

Result ExampleResult(Verdict verdict) {
  Result r = Common(verdict);
  switch (verdict) {
    case Verdict::kNamed: MakeNamed(&r); break;
    case Verdict::kAmbiguous: MakeAmbiguous(&r); break;
    case Verdict::kUnnamed: MakeUnnamed(&r); break;
    case Verdict::kNone: MakeNone(&r); break;
  }
  return r;
}

}  // namespace armcmc::gap::test
