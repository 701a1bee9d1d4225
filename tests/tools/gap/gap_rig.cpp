#include "tools/gap/gap_rig.hpp"

#include <random>
#include <stdexcept>

namespace armcmc::gap::test {
namespace {

Vector Column(const std::vector<double>& values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

Recording MakeRecording(const Vector& t, const Vector& x, const Vector& v, const Vector& f) {
  Recording recording;
  recording.source = "made.csv";
  recording.t = t;
  recording.dt = t.size() > 1 ? (t[t.size() - 1] - t[0]) / static_cast<double>(t.size() - 1) : 0.0;
  recording.names = {"t", "x", "v", "f"};
  recording.columns = {t, x, v, f};
  return recording;
}

Vector Noise(Eigen::Index rows, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  return Vector::NullaryExpr(rows, [&] { return normal(engine); });
}

Recording RecordingOf(const armcmc::test::Series& series, double noise_sd, unsigned seed) {
  const auto rows = static_cast<Eigen::Index>(series.size());
  Recording recording = MakeRecording(Column(series.t), Column(series.x), Column(series.v),
                                      Column(series.f) + noise_sd * Noise(rows, seed));
  recording.dt = series.dt;
  return recording;
}

Made Measure(const std::vector<armcmc::test::HiddenEffect>& effects, int rows, double noise_sd, unsigned seed,
             double dt) {
  armcmc::test::Series series(rows);
  series.dt = dt;
  for (int n = 0; n < rows; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const double s = dt * n;
    series.t[i] = s;
    series.x[i] = 0.35 + 0.5 * std::sin(3.1 * s - 0.4) + 0.3 * std::sin(7.3 * s) + 0.12 * std::sin(17.9 * s + 1.0);
    series.v[i] =
        0.5 * 3.1 * std::cos(3.1 * s - 0.4) + 0.3 * 7.3 * std::cos(7.3 * s) + 0.12 * 17.9 * std::cos(17.9 * s + 1.0);
  }
  armcmc::test::Simulate(effects, &series);
  return {RecordingOf(series, noise_sd, seed), Column(series.f)};
}

armcmc::test::HiddenEffect Hidden(const std::string& name) {
  for (const armcmc::test::HiddenEffect& effect : armcmc::test::Catalogue())
    if (effect.name == name) return effect;
  throw std::invalid_argument(name + " has no reference");
}

Bench::Bench(Recording made, int window)
    : equation(std::move(MakeEquations("hunt_crossley").front())),
      recording(std::move(made)),
      signals(equation->Prepare(recording, window)),
      catalogue(equation->Catalogue(signals)) {}

const EffectForm& Bench::Form(const std::string& effect, const std::string& variant) const {
  for (const EffectForm& form : catalogue)
    if (form.effect == effect && form.variant == variant) return form;
  throw std::invalid_argument(effect + " " + variant + " is not of the catalogue");
}

Whitener White(double sd) { return {Vector(), sd * sd}; }

}  // namespace armcmc::gap::test
