#include "armcmc/replay/course.hpp"

#include <cmath>
#include <limits>

#include "armcmc/estimator.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/replay/recording_source.hpp"
#include "armcmc/replay/replay.hpp"

namespace armcmc::replay {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kNormalQuantile = 1.959964;

}  // namespace

double UpperQuantile(const NoiseSettings& noise) {
  constexpr double kStep = 1e-3, kMost = 1e3;
  NoiseSettings unit = noise;
  unit.mean = 0.0;
  const NoiseModel law(unit);
  // The laws are symmetric; the trapezoidal rule from the centre on.
  double mass = 0.0, e = 0.0;
  for (double before = std::exp(law.LogDensity(0.0, 1.0)); mass < 0.475 && e < kMost;) {
    e += kStep;
    const double now = std::exp(law.LogDensity(e, 1.0));
    mass += 0.5 * kStep * (before + now);
    before = now;
  }
  return e;
}

Course PredictPackAhead(const EstimatorSettings& settings, const std::shared_ptr<const support::Recording>& recording,
                        int samples_per_pack, const std::function<void(double share)>& progress) {
  Estimator estimator(settings);
  SourceRequest request;
  request.recording = recording;
  request.described = settings.plant;
  request.plant = estimator.plant();
  request.num_inputs = estimator.num_inputs();
  request.period = samples_per_pack * recording->dt;
  RecordingSource source(request, {});

  Course course;
  course.error.assign(recording->num_rows(), kUnknown);
  course.half_width.assign(recording->num_rows(), kUnknown);
  const double quantile = UpperQuantile(settings.noise[0]);
  const auto forecast = std::make_unique<PackForecast>();
  (void)Replay(
      &source, &estimator,
      [&](const RecordedPack& recorded, const Estimate& /*estimate*/) {
        const auto samples = static_cast<std::size_t>(recorded.pack.num_samples);
        const std::size_t first = recording->runs[static_cast<std::size_t>(recorded.pack.run_id - 1)] +
                                  static_cast<std::size_t>(recorded.pack.seq - 1) * samples;
        course.pack_s = static_cast<double>(samples) * recording->dt;
        for (std::size_t n = 0; n < samples; ++n) {
          course.error[first + n] = forecast->target[n] - forecast->centre[n];
          course.half_width[first + n] =
              std::hypot(kNormalQuantile * forecast->sd[n], quantile * forecast->noise_std[n]);
        }
        if (progress) progress(source.progress());
      },
      forecast.get());
  return course;
}

}  // namespace armcmc::replay
