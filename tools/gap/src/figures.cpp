#include "armcmc/gap/figures.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace armcmc::gap {
namespace {

constexpr int kBins = 24;
constexpr int kMapBins = 16;
constexpr int kMinInBin = 20;
constexpr int kSegments = 16;  // of the spectrum, averaged
constexpr double kDrawnBand = 1.96;

std::vector<double> Copy(const Vector& v) { return {v.data(), v.data() + v.size()}; }

/// Edges that hold equally many samples each.
std::vector<double> Edges(const Vector& series, int bins) {
  std::vector<double> sorted = Copy(series);
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> edges;
  for (int b = 0; b <= bins; ++b) {
    const double edge = sorted[static_cast<std::size_t>(static_cast<double>(sorted.size() - 1) * b / bins)];
    if (edges.empty() || edge > edges.back()) edges.push_back(edge);
  }
  return edges;
}

std::size_t BinOf(const std::vector<double>& edges, double value) {
  const auto above = std::upper_bound(edges.begin(), edges.end(), value) - edges.begin();
  return static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(above - 1, 0, static_cast<std::ptrdiff_t>(edges.size()) - 2));
}

/// Mean of `value` in bins of `feature`, with its 95 % band; `spread` is the sd of a mean over one sample.
Curve Binned(const std::string& label, const Vector& feature, const Vector& value, double inflation) {
  const std::vector<double> edges = Edges(feature, kBins);
  Curve curve;
  curve.label = label;
  if (edges.size() < 3) return curve;
  const std::size_t bins = edges.size() - 1;
  std::vector<double> count(bins), sum(bins), square(bins), at(bins);
  for (Eigen::Index i = 0; i < feature.size(); ++i) {
    const std::size_t b = BinOf(edges, feature[i]);
    count[b] += 1.0;
    sum[b] += value[i];
    square[b] += value[i] * value[i];
    at[b] += feature[i];
  }
  for (std::size_t b = 0; b < bins; ++b) {
    if (count[b] < kMinInBin) continue;
    const double mean = sum[b] / count[b];
    const double sd = std::sqrt(std::max(square[b] / count[b] - mean * mean, 0.0) * inflation / count[b]);
    curve.x.push_back(at[b] / count[b]);
    curve.y.push_back(mean);
    curve.low.push_back(mean - kDrawnBand * sd);
    curve.high.push_back(mean + kDrawnBand * sd);
  }
  return curve;
}

/// Power of the whitened residual over that of white noise, averaged over segments.
Curve Spectrum(const std::string& label, const Vector& white, double variance, double dt) {
  const auto length = static_cast<std::size_t>(white.size() / kSegments);
  Curve curve;
  curve.label = label;
  Eigen::FFT<double> fft;
  std::vector<double> power(length / 2, 0.0);
  double window_power = 0.0;
  for (int s = 0; s < kSegments; ++s) {
    std::vector<double> part(length);
    window_power = 0.0;
    for (std::size_t i = 0; i < length; ++i) {
      const double hann =
          0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(length));
      window_power += hann * hann;
      part[i] = hann * white[static_cast<Eigen::Index>(static_cast<std::size_t>(s) * length + i)];
    }
    std::vector<std::complex<double>> transform;
    fft.fwd(transform, part);
    for (std::size_t k = 0; k < power.size(); ++k) power[k] += std::norm(transform[k]) / kSegments;
  }
  for (std::size_t k = 1; k < power.size(); ++k) {
    curve.x.push_back(static_cast<double>(k) / (static_cast<double>(length) * dt));
    curve.y.push_back(power[k] / (variance * window_power));
  }
  return curve;
}

MapFigure Map(const std::string& x_title, const std::string& y_title, const Vector& x, const Vector& y,
              const Vector& excess) {
  MapFigure map;
  map.x_title = x_title;
  map.y_title = y_title;
  map.value_title = "squared error over the noise variance";
  map.x_edges = Edges(x, kMapBins);
  map.y_edges = Edges(y, kMapBins);
  if (map.x_edges.size() < 2 || map.y_edges.size() < 2) return {};
  const std::size_t columns = map.x_edges.size() - 1, rows = map.y_edges.size() - 1;
  std::vector<double> count(columns * rows), sum(columns * rows);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const std::size_t cell = BinOf(map.y_edges, y[i]) * columns + BinOf(map.x_edges, x[i]);
    count[cell] += 1.0;
    sum[cell] += excess[i];
  }
  map.value.assign(columns * rows, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t cell = 0; cell < sum.size(); ++cell)
    if (count[cell] >= 5.0) map.value[cell] = sum[cell] / count[cell];
  return map;
}

}  // namespace

Figures MakeFigures(const Equation& equation, const Signals& signals, const Analysis& analysis, const Fitted& before,
                    const Fitted& after) {
  const Whitener& whitener = analysis.fitter->whitener();
  const Vector first = Evaluate(equation, signals, before.hypothesis, before.theta, Slopes::None()).y;
  const Vector second = Evaluate(equation, signals, after.hypothesis, after.theta, Slopes::None()).y;
  const Vector error_before = signals.output - first, error_after = signals.output - second;
  Figures figures;
  figures.output_title = equation.output_name() + ", " + equation.output_unit();
  const std::vector<double> t = Copy(signals.t);
  figures.measured = {"measured", t, Copy(signals.output), {}, {}};
  figures.predicted_before = {"model before", t, Copy(first), {}, {}};
  figures.predicted_after = {"model after", t, Copy(second), {}, {}};
  figures.residual_before = {"before", t, Copy(error_before), {}, {}};
  figures.residual_after = {"after", t, Copy(error_after), {}, {}};
  const double inflation =
      std::max(whitener.Gain() > 0.0 ? 1.0 / std::pow(1.0 - whitener.phi.sum(), 2) / whitener.Gain() : 1.0, 1.0);
  const bool added = !after.hypothesis.terms.empty();
  for (const PlotFeature& feature : equation.PlotFeatures(signals)) {
    FeatureFigure figure;
    figure.feature = feature.title;
    figure.before = Binned("before", feature.value, error_before, inflation);
    figure.after = Binned("after", feature.value, error_after, inflation);
    if (added) figure.effect = Binned("effect", feature.value, second - first, 0.0);
    figures.features.push_back(std::move(figure));
  }
  const Vector white_before = whitener.Apply(error_before), white_after = whitener.Apply(error_after);
  figures.spectrum_before = Spectrum("before", white_before, whitener.variance, signals.dt);
  figures.spectrum_after = Spectrum("after", white_after, whitener.variance, signals.dt);
  const std::vector<PlotFeature> axes = equation.PlotFeatures(signals);
  if (axes.size() >= 2)
    figures.where = Map(axes[0].title, axes[1].title, axes[0].value, axes[1].value,
                        Vector(white_before.array().square() / whitener.variance));
  return figures;
}

}  // namespace armcmc::gap
