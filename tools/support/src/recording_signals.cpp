#include "recording_signals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "armcmc/expression/operation.hpp"
#include "armcmc/expression/syntax.hpp"
#include "armcmc/support/csv.hpp"
#include "armcmc/support/text_table.hpp"
#include "zero_phase.hpp"

namespace armcmc::support {
namespace {

constexpr double kGap = 4.5;        ///< Median intervals from which on a jump of time is a gap.
constexpr double kUneven = 0.02;    ///< Of an interval, that time may be off before the rows are interpolated.
constexpr std::size_t kShort = 10;  ///< Samples that a run needs.

/// The decimal number that was meant: times are written in decimals, and their differences are not.
double Snapped(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.7g", value);
  return std::strtod(text.data(), nullptr);
}

double MedianStep(const RecordingRows& rows) {
  std::vector<double> steps;
  for (std::size_t n = 1; n < rows.size(); ++n)
    if (rows.new_run[n] == 0) steps.push_back(rows.t[n] - rows.t[n - 1]);
  if (steps.empty()) return 1.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// Where a sample lies: that part of the way from a row to the next.
struct Place {
  std::size_t row;
  double part;
};

/// What interpolation leaves of white noise, and what it tells.
class InterpolatedNoise {
 public:
  /// A run of samples.
  void Add(const std::vector<Place>& places) {
    constexpr std::array<double, 4> kThird{1.0, -3.0, 3.0, -1.0};
    for (std::size_t k = 0; k < places.size(); ++k) {
      in_samples_ += std::pow(1.0 - places[k].part, 2) + std::pow(places[k].part, 2);
      ++samples_;
      if (k + 1 < kThird.size()) continue;
      std::map<std::size_t, double> weight;  // of a row
      for (std::size_t i = 0; i < kThird.size(); ++i) {
        const Place& at = places[k - i];
        weight[at.row] += kThird[i] * (1.0 - at.part);
        weight[at.row + 1] += kThird[i] * at.part;
      }
      for (const auto& [row, w] : weight) in_differences_ += w * w / 20.0;
      ++differences_;
    }
  }
  [[nodiscard]] double in_samples() const { return samples_ > 0.0 ? std::sqrt(in_samples_ / samples_) : 1.0; }
  [[nodiscard]] double in_differences() const {
    return differences_ > 0.0 ? std::sqrt(in_differences_ / differences_) : 1.0;
  }

 private:
  double in_samples_ = 0.0, in_differences_ = 0.0, samples_ = 0.0, differences_ = 0.0;
};

/// Interval of the rows [first, last): their mean where they are even, which a median of rounded times is not.
bool IsEven(const std::vector<double>& t, std::size_t first, std::size_t last, double dt) {
  for (std::size_t n = first; n < last; ++n)
    if (std::fabs(t[n] - t[first] - static_cast<double>(n - first) * dt) > kUneven * dt) return false;
  return true;
}

struct Span {
  std::size_t first, last;
};

std::vector<Span> Runs(const RecordingRows& rows, double dt) {
  std::vector<Span> runs;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const bool begins = n == 0 || rows.new_run[n] != 0 || rows.t[n] - rows.t[n - 1] > kGap * dt;
    if (begins) runs.push_back({n, n});
    runs.back().last = n + 1;
  }
  return runs;
}

}  // namespace

void Resample(const RecordingRows& rows, Recording* recording) {
  const double median = MedianStep(rows);
  std::vector<Span> runs = Runs(rows, median);
  const std::size_t all = runs.size();
  std::erase_if(runs, [](const Span& run) { return run.last - run.first < kShort; });
  if (runs.size() < all)
    recording->notes.push_back(std::to_string(all - runs.size()) + " runs of fewer than " + std::to_string(kShort) +
                               " rows are left out");
  // Rounded times have a rounded median: the longest run knows better.
  const auto longest = std::max_element(
      runs.begin(), runs.end(), [](const Span& a, const Span& b) { return a.last - a.first < b.last - b.first; });
  double dt = Snapped(median);
  if (longest != runs.end()) {
    const double mean =
        (rows.t[longest->last - 1] - rows.t[longest->first]) / static_cast<double>(longest->last - 1 - longest->first);
    if (IsEven(rows.t, longest->first, longest->last, mean)) dt = Snapped(mean);
  }
  recording->dt = dt;
  std::size_t resampled = 0;
  InterpolatedNoise noise;
  std::vector<Place> places;
  for (const Span& run : runs) {
    places.clear();
    recording->runs.push_back(recording->t.size());
    const bool even = IsEven(rows.t, run.first, run.last, dt);
    resampled += even ? 0 : 1;
    const double start = rows.t[run.first];
    const double length = rows.t[run.last - 1] - start;
    const std::size_t count =
        even ? run.last - run.first : static_cast<std::size_t>(std::floor(length / dt * (1.0 + 1e-9))) + 1;
    std::size_t n = run.first;
    for (std::size_t k = 0; k < count; ++k) {
      const double t = start + static_cast<double>(k) * dt;
      if (even) {
        n = run.first + k;
      } else {
        while (n + 2 < run.last && rows.t[n + 1] <= t) ++n;
      }
      const double part = even ? 0.0 : std::clamp((t - rows.t[n]) / (rows.t[n + 1] - rows.t[n]), 0.0, 1.0);
      places.push_back({n, part});
      recording->t.push_back(t);
      recording->held_out.push_back(rows.held_out[n]);
      for (std::size_t s = 0; s < rows.signal.size(); ++s) {
        if (rows.signal[s].empty()) continue;
        const double a = rows.signal[s][n];
        recording->signals[s].value.push_back(even ? a : a + part * (rows.signal[s][n + 1] - a));
      }
    }
    noise.Add(places);
  }
  if (resampled > 0) {
    recording->noise_in_samples = noise.in_samples();
    recording->noise_in_differences = noise.in_differences();
  }
  if (resampled > 0)
    recording->notes.push_back("time is uneven in " + std::to_string(resampled) + " of " + std::to_string(runs.size()) +
                               " runs: interpolated to one sample every " + ExactNumber(dt) + " s");
  if (recording->runs.size() > 1)
    recording->notes.push_back(std::to_string(recording->runs.size()) +
                               " runs: neither states nor derivatives are carried from one to the next");
}

namespace {

template <class Function>
std::vector<double> RunByRun(const Recording& recording, const std::vector<double>& x, Function function) {
  std::vector<double> out;
  out.reserve(x.size());
  for (std::size_t r = 0; r < recording.runs.size(); ++r) {
    const std::size_t end = r + 1 < recording.runs.size() ? recording.runs[r + 1] : x.size();
    const std::vector<double> part(x.begin() + static_cast<std::ptrdiff_t>(recording.runs[r]),
                                   x.begin() + static_cast<std::ptrdiff_t>(end));
    const std::vector<double> done = function(part);
    out.insert(out.end(), done.begin(), done.end());
  }
  return out;
}

std::vector<double> Filtered(const Recording& recording, const std::vector<double>& x, double bandwidth) {
  return RunByRun(recording, x,
                  [&](const std::vector<double>& run) { return ZeroPhase(run, recording.dt, bandwidth); });
}

/// The best factor from `derived` to `given`, and how well it explains it.
struct Agreement {
  double factor = 0.0, correlation = 0.0;
};

Agreement Compare(const std::vector<double>& given, const std::vector<double>& derived) {
  double gd = 0.0, dd = 0.0, gg = 0.0;
  for (std::size_t n = 0; n < given.size(); ++n) {
    gd += given[n] * derived[n];
    dd += derived[n] * derived[n];
    gg += given[n] * given[n];
  }
  if (!(dd > 0.0) || !(gg > 0.0)) return {};
  return {gd / dd, gd / std::sqrt(dd * gg)};
}

/// What a factor between a signal and a rate would come from.
std::string LikelyCause(double factor) {
  struct Known {
    double factor;
    const char* cause;
  };
  constexpr std::array<Known, 12> kKnown{{{1000.0, "thousandths (mm for m, ms for s)"},
                                          {1e6, "millionths"},
                                          {100.0, "hundredths (cm for m, percent)"},
                                          {10.0, "tenths"},
                                          {39.37007874, "inches for metres"},
                                          {25.4, "inches for millimetres"},
                                          {180.0 / std::numbers::pi, "degrees for radians"},
                                          {2.0 * std::numbers::pi, "turns for radians"},
                                          {60.0, "minutes for seconds"},
                                          {60.0 / (2.0 * std::numbers::pi), "turns a minute for rad/s"},
                                          {3.6, "km/h for m/s"},
                                          {3.280839895, "feet for metres"}}};
  const double size = std::fabs(factor) >= 1.0 ? std::fabs(factor) : 1.0 / std::fabs(factor);
  for (const Known& known : kKnown)
    if (std::fabs(size / known.factor - 1.0) < 0.1) return std::string("; likely ") + known.cause;
  return std::fabs(factor + 1.0) < 0.25 ? "; likely its sign" : "";
}

/// Standard deviation of white noise, from third differences of neighbouring samples, which smooth signals hardly have.
double Roughness(const Recording& recording, const std::vector<double>& value) {
  double square = 0.0;
  std::size_t count = 0;
  for (std::size_t r = 0; r < recording.runs.size(); ++r) {
    const std::size_t end = r + 1 < recording.runs.size() ? recording.runs[r + 1] : value.size();
    for (std::size_t n = recording.runs[r] + 3; n < end; ++n, ++count)
      square += std::pow(value[n] - 3.0 * value[n - 1] + 3.0 * value[n - 2] - value[n - 3], 2);
  }
  return count > 0 ? std::sqrt(square / (20.0 * static_cast<double>(count))) : 0.0;
}

/// The first function in a law whose past a run does not have; empty: there is none.
std::string MemoryOf(const PlantDescription& plant) {
  std::vector<std::string> texts{plant.law, plant.predicts};
  for (const ModeDescription& mode : plant.modes) texts.push_back(mode.law);
  for (const LetDescription& let : plant.lets) texts.push_back(let.text);
  for (const std::string& text : texts) {
    if (text.empty()) continue;
    for (const expression::SyntaxNode& node : expression::Parse(text).nodes)
      if (node.op == expression::Op::kLowpass || node.op == expression::Op::kDelay)
        return std::string(expression::InfoOf(node.op).name);
  }
  return "";
}

}  // namespace

void Derive(const RecordingFile& file, const PlantDescription& plant, const std::string& name, Recording* recording) {
  const auto index_of = [&](const std::string& signal) {
    for (std::size_t s = 0; s < plant.signals.size(); ++s)
      if (plant.signals[s].name == signal) return s;
    return plant.signals.size();
  };
  if (file.bandwidth_hz > 0.0)
    for (const std::string& signal : file.filtered_with) {
      std::vector<double>& value = recording->signals[index_of(signal)].value;
      if (value.empty()) continue;
      if (signal == plant.output)
        recording->smoothed_noise = Roughness(*recording, value) / recording->noise_in_differences *
                                    std::sqrt(std::min(1.0, 2.0 * file.bandwidth_hz * recording->dt));
      value = Filtered(*recording, value, file.bandwidth_hz);
      recording->notes.push_back(signal + ": zero-phase low pass, " + ExactNumber(file.bandwidth_hz) + " Hz");
    }
  if (file.bandwidth_hz * recording->dt >= 0.5)
    recording->notes.push_back("bandwidth_hz = " + ExactNumber(file.bandwidth_hz) +
                               " is not below half the sample rate, " + Significant(0.5 / recording->dt, 4) +
                               " Hz: it filters nothing");
  if (const std::string memory = MemoryOf(plant); recording->runs.size() > 1 && !memory.empty())
    recording->notes.push_back(memory + "() begins each run at rest: where runs begin in motion, write it as a state " +
                               "that starts from a signal");
  // One may be derived from another that is derived itself.
  for (std::size_t round = 0; round < plant.signals.size(); ++round)
    for (std::size_t s = 0; s < plant.signals.size(); ++s) {
      if (plant.signals[s].derivative_of.empty()) continue;
      const std::size_t of = index_of(plant.signals[s].derivative_of);
      std::vector<double>& value = recording->signals[s].value;
      const std::vector<double>& base = recording->signals[of].value;
      if (base.empty() || (!value.empty() && round > 0)) continue;
      const double bandwidth = file.bandwidth_hz > 0.0 ? file.bandwidth_hz : SuitableBandwidth(base, recording->dt);
      const std::vector<double> rate =
          RunByRun(*recording, Filtered(*recording, base, bandwidth),
                   [&](const std::vector<double>& run) { return Derivative(run, recording->dt); });
      if (value.empty()) {
        value = rate;
        recording->notes.push_back(plant.signals[s].name + " is derived from " + plant.signals[s].derivative_of + ", " +
                                   Significant(bandwidth, 3) + " Hz" +
                                   (file.bandwidth_hz > 0.0 ? "" : ", chosen from the noise level"));
        continue;
      }
      const Agreement agreement = Compare(value, rate);
      const bool off = agreement.factor < 0.8 || agreement.factor > 1.25;
      if (std::fabs(agreement.correlation) > 0.8 && off) {
        const std::string problem = "is " + Significant(agreement.factor, 4) + " times the derivative of " +
                                    plant.signals[s].derivative_of +
                                    ": a unit is wrong, of one of them or of the time" + LikelyCause(agreement.factor);
        if (file.root) throw StrictTable(*file.root).Table("columns").Error(plant.signals[s].name, problem);
        throw ConfigError(name + ": columns." + plant.signals[s].name + ": " + problem);
      }
      if (std::fabs(agreement.correlation) <= 0.8)
        recording->notes.push_back(plant.signals[s].name + " as given does not look like the derivative of " +
                                   plant.signals[s].derivative_of + " (correlation " +
                                   Significant(agreement.correlation, 2) + ")");
    }
}

}  // namespace armcmc::support
