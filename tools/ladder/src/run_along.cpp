#include "run_along.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "armcmc/replay/course.hpp"
#include "armcmc/support/pack_length.hpp"

namespace armcmc::ladder {
namespace {

/// Draws for each pack, limited so that long recordings remain affordable.
int DrawsFor(std::size_t rows) {
  constexpr double kWork = 4e7;  // rows times draws
  return static_cast<int>(std::clamp(kWork / static_cast<double>(rows), 300.0, 4000.0));
}

/// The first part of every run, to limit the total number of rows.
std::shared_ptr<const support::Recording> FirstPart(const std::shared_ptr<const support::Recording>& all) {
  constexpr double kMostRows = 5e4;
  const double share = kMostRows / static_cast<double>(all->num_rows());
  if (share >= 1.0) return all;
  auto part = std::make_shared<support::Recording>(*all);
  std::vector<std::size_t> rows;
  for (std::size_t r = 0; r < all->runs.size(); ++r) {
    const std::size_t end = r + 1 < all->runs.size() ? all->runs[r + 1] : all->num_rows();
    part->runs[r] = rows.size();
    const auto kept = static_cast<std::size_t>(share * static_cast<double>(end - all->runs[r]));
    for (std::size_t n = 0; n < kept; ++n) rows.push_back(all->runs[r] + n);
  }
  const auto keep = [&rows](auto* of) {
    for (std::size_t n = 0; n < rows.size(); ++n) (*of)[n] = (*of)[rows[n]];
    of->resize(rows.size());
  };
  keep(&part->t);
  keep(&part->held_out);
  for (support::RecordedSignal& signal : part->signals) keep(&signal.value);
  return part;
}

/// Settings as live; long recordings use the longest packs.
int SamplesPerPack(const support::Recording& recording) {
  constexpr std::size_t kMostPacks = 600;
  const int usual = support::SuitablePackLength(recording.dt, kMaxPackSamples);
  return recording.num_rows() / static_cast<std::size_t>(usual) > kMostPacks ? kMaxPackSamples : usual;
}

replay::Course Follow(const TunedPlant& tuned, const std::shared_ptr<const support::Recording>& recording,
                      std::uint64_t seed, const std::function<void(double share)>& progress) {
  EstimatorSettings settings = DescribedSettings(tuned.program);
  settings.sampler.seed = seed;
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = DrawsFor(recording->num_rows());
  settings.gap_watch.enabled = false;
  return replay::PredictPackAhead(settings, recording, SamplesPerPack(*recording), progress);
}

bool Predicted(const replay::Course& course, std::size_t n) {
  return std::isfinite(course.error[n]) && std::isfinite(course.half_width[n]);
}

/// @param both  Null if there is only one model.
gap::OneStepScore Score(const replay::Course& course, const replay::Course* both, const support::Recording& recording,
                        bool apart) {
  gap::OneStepScore score;
  double square = 0.0, inside = 0.0, width = 0.0;
  for (std::size_t n = 0; n < course.error.size(); ++n) {
    if (!Predicted(course, n) || (both != nullptr && !Predicted(*both, n))) continue;
    if (apart && recording.held_out[n] == 0) continue;
    ++score.samples;
    square += course.error[n] * course.error[n];
    inside += std::fabs(course.error[n]) <= course.half_width[n] ? 1.0 : 0.0;
    width += course.half_width[n];
  }
  const auto samples = static_cast<double>(score.samples);  // none: NaN
  score.rmse = std::sqrt(square / samples);
  score.coverage95 = inside / samples;
  score.half_width = width / samples;
  return score;
}

gap::Curve ErrorCurve(const replay::Course& course, const support::Recording& recording) {
  gap::Curve curve;
  for (std::size_t n = 0; n < course.error.size(); ++n) {
    curve.x.push_back(recording.t.front() + static_cast<double>(n) * recording.dt);
    curve.y.push_back(course.error[n]);
    curve.low.push_back(-course.half_width[n]);
    curve.high.push_back(course.half_width[n]);
  }
  return curve;
}

}  // namespace

gap::RunAlong RunAlong(const std::shared_ptr<const support::Recording>& whole, const TunedPlant& before,
                       const TunedPlant* after, std::uint64_t seed, const std::function<void(double share)>& progress) {
  gap::RunAlong run;
  for (const TunedPlant* plant : {&before, after}) {
    if (plant == nullptr || plant->program != nullptr) continue;
    run.why_not = "the estimator cannot run the model" + std::string(plant == after ? " with what was named: " : ": ") +
                  plant->why_not;
    return run;
  }
  const auto part = [&](double begin, double size) {
    return [&progress, begin, size](double share) {
      if (progress) progress(begin + size * share);
    };
  };
  try {
    const std::shared_ptr<const support::Recording> recording = FirstPart(whole);
    const double half = after != nullptr ? 0.5 : 1.0;
    const replay::Course first = Follow(before, recording, seed, part(0.0, half));
    replay::Course second;
    if (after != nullptr) second = Follow(*after, recording, seed, part(half, half));
    const replay::Course* both = after != nullptr ? &second : nullptr;
    run.done = true;
    run.has_after = after != nullptr;
    run.pack_s = first.pack_s;
    run.before = Score(first, both, *recording, false);
    run.before_apart = Score(first, both, *recording, true);
    run.error_before = ErrorCurve(first, *recording);
    if (after == nullptr) return run;
    run.after = Score(second, &first, *recording, false);
    run.after_apart = Score(second, &first, *recording, true);
    run.error_after = ErrorCurve(second, *recording);
  } catch (const std::exception& error) {
    // The diagnosis is valid even if this recording contains no complete pack.
    run = {};
    run.why_not = error.what();
  }
  return run;
}

}  // namespace armcmc::ladder
