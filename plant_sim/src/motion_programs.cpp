// Paths of the motion programs, in units of their depth, at pace 1.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "armcmc/plant_sim/motion.hpp"
#include "armcmc/plant_sim/rng.hpp"

namespace armcmc::plant_sim {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr std::uint64_t kMotionStream = 0xd0;

/// Share of the period that has passed, in [0, 1).
double Share(double t, double period) noexcept { return t / period - std::floor(t / period); }
/// 0 to 1 and back over a period.
double Tap(double share) noexcept { return 0.5 - 0.5 * std::cos(kTwoPi * share); }
double Blend(double from, double to, double share) noexcept { return from + (to - from) * std::clamp(share, 0.0, 1.0); }

/// Phase (rad) of a sweep from 0.3 to 8 Hz in 10 s, equally long in every octave, and back again, and so on.
double SweepPhase(double t) noexcept {
  constexpr double kLow = 0.3, kHigh = 8.0, kLength = 10.0;
  const double octaves = std::log(kHigh / kLow);
  const auto up = [&](double s) { return kTwoPi * kLow * kLength / octaves * std::expm1(octaves * s / kLength); };
  const double cycles = std::floor(t / (2.0 * kLength)), s = t - cycles * 2.0 * kLength;
  return 2.0 * cycles * up(kLength) + (s < kLength ? up(s) : 2.0 * up(kLength) - up(2.0 * kLength - s));
}

double Sine(double t) noexcept { return 0.5 + 0.31 * std::sin(kTwoPi * t); }

double SlowTriangle(double t) noexcept {
  constexpr double kPeriod = 4.0;
  return -0.1 + 1.1 * (1.0 - std::abs(2.0 * Share(t, kPeriod) - 1.0));
}

double FastTaps(double t) noexcept {
  constexpr double kRate = 5.0;
  return -0.15 + 1.15 * Tap(Share(t, 1.0 / kRate));
}

double StepHold(double t) noexcept {
  constexpr double kPeriod = 2.0, kRise = 0.05, kHeld = 1.4, kOut = 0.1, kAir = -0.1;
  constexpr std::array<double, 3> kLevels = {1.0, 0.5, 0.75};
  const double level = kLevels[static_cast<std::size_t>(t / kPeriod) % kLevels.size()];
  const double s = kPeriod * Share(t, kPeriod);
  return s < kHeld ? Blend(kAir, level, s / kRise) : Blend(level, kAir, (s - kHeld) / kOut);
}

double TapsOfDepths(double t) noexcept {
  constexpr double kPeriod = 0.8, kAir = -0.1;
  constexpr std::array<double, 6> kDepths = {0.3, 0.9, 0.5, 1.0, 0.2, 0.7};
  const double depth = kDepths[static_cast<std::size_t>(t / kPeriod) % kDepths.size()];
  return kAir + (depth - kAir) * Tap(Share(t, kPeriod));
}

double ContactChirp(double t) noexcept { return 0.6 + 0.35 * std::sin(SweepPhase(t)); }
double FreeAirChirp(double t) noexcept { return -0.6 + 0.4 * std::sin(SweepPhase(t)); }
double FreeAir(double t) noexcept {
  return -0.7 + 0.2 * (std::sin(kTwoPi * 0.37 * t) + std::sin(kTwoPi * 1.3 * t) + std::sin(kTwoPi * 3.1 * t));
}

class FixedPath final : public Path {
 public:
  explicit FixedPath(double (*position)(double) noexcept) : position_(position) {}
  [[nodiscard]] double At(double time_s) noexcept override { return position_(time_s); }

 private:
  double (*position_)(double) noexcept;
};

/// Free motion, taps, holds, sums of sines and ramps in a random order, each 0.35 to 1.1 s long.
class RichPath final : public Path {
 public:
  explicit RichPath(std::uint64_t seed) : rng_(seed, kMotionStream) { Draw(); }

  [[nodiscard]] double At(double time_s) noexcept override {
    while (time_s >= end_) {
      from_ = last_;
      begin_ = end_;
      Draw();
    }
    return last_ = Position(time_s - begin_);
  }

 private:
  enum class Kind : std::uint8_t { kFree, kTap, kHold, kWaves, kRamp };
  static constexpr double kAir = -0.15;
  struct Wave {
    double amplitude, omega, phase;
  };

  [[nodiscard]] double Between(double lo, double hi) noexcept { return lo + (hi - lo) * rng_.Uniform(); }

  void Draw() noexcept {
    // Contact teaches more than air: taps, holds and waves come twice as often.
    constexpr std::array<Kind, 8> kKinds = {Kind::kFree, Kind::kRamp, Kind::kTap,   Kind::kTap,
                                            Kind::kHold, Kind::kHold, Kind::kWaves, Kind::kWaves};
    kind_ = kKinds[std::min(static_cast<std::size_t>(Between(0.0, kKinds.size())), kKinds.size() - 1)];
    end_ = begin_ + Between(0.35, 1.1);
    level_ = kind_ == Kind::kRamp ? Between(-0.2, 0.9) : Between(0.15, 1.0);
    for (Wave& wave : waves_) wave = {Between(0.025, 0.12), kTwoPi * Between(0.8, 8.0), Between(0.0, kTwoPi)};
  }

  [[nodiscard]] double Position(double s) const noexcept {
    const double share = s / (end_ - begin_);
    switch (kind_) {
      case Kind::kFree: return -0.21 + waves_[0].amplitude * std::sin(waves_[0].omega * s);
      case Kind::kTap: return kAir + (level_ - kAir) * Tap(share);
      case Kind::kHold: return share < 0.8 ? Blend(from_, level_, 4.0 * share) : Blend(level_, kAir, 5.0 * share - 4.0);
      case Kind::kRamp: return Blend(from_, level_, share);
      case Kind::kWaves: break;
    }
    double position = 0.1 + 0.5 * level_;
    for (const Wave& wave : waves_) position += wave.amplitude * std::sin(wave.omega * s + wave.phase);
    return position;
  }

  Rng rng_;
  Kind kind_ = Kind::kFree;
  double begin_ = 0.0, end_ = 0.0, level_ = 0.0, from_ = kAir, last_ = kAir;
  std::array<Wave, 4> waves_{};
};

/// Strokes of a press or a force microscope: in and out again, each way straight at a speed of its own, with a rest at
/// both ends.
class StrokesPath final : public Path {
 public:
  explicit StrokesPath(std::uint64_t seed) : rng_(seed, kMotionStream) {}

  [[nodiscard]] double At(double time_s) noexcept override {
    while (time_s >= legs_.back().end_s) DrawStroke();
    std::size_t leg = 0;
    while (time_s >= legs_[leg].end_s) ++leg;
    const double begin_s = leg == 0 ? begin_s_ : legs_[leg - 1].end_s;
    return Blend(leg == 0 ? kAir : legs_[leg - 1].to, legs_[leg].to, (time_s - begin_s) / (legs_[leg].end_s - begin_s));
  }

 private:
  static constexpr double kAir = -0.2;
  struct Leg {
    double end_s, to;
  };

  [[nodiscard]] double Between(double lo, double hi) noexcept { return lo + (hi - lo) * rng_.Uniform(); }

  void DrawStroke() noexcept {
    constexpr double kSlowest = 0.7, kFastest = 4.0;  // depths a second
    const auto speed = [this] { return kSlowest * std::pow(kFastest / kSlowest, rng_.Uniform()); };
    const double depth = Between(0.4, 1.0), way = depth - kAir;
    begin_s_ = legs_.back().end_s;
    double at = begin_s_;
    legs_[0] = {at += way / speed(), depth};
    legs_[1] = {at += Between(0.02, 0.2), depth};
    legs_[2] = {at += way / speed(), kAir};
    legs_[3] = {at + Between(0.02, 0.2), kAir};
  }

  Rng rng_;
  double begin_s_ = 0.0;  ///< Of the stroke.
  std::array<Leg, 4> legs_{};
};

/// What somebody recorded, from one of its times on; at its end it runs back, and at its beginning forth again.
class RecordedPath final : public Path {
 public:
  RecordedPath(std::shared_ptr<const Series> recording, double start_s)
      : recording_(std::move(recording)), start_s_(start_s) {}

  [[nodiscard]] double At(double time_s) noexcept override {
    const std::vector<double>& values = recording_->values;
    const auto last = static_cast<double>(values.size() - 1);
    const double there_and_back = 2.0 * last, way = (start_s_ + time_s) / recording_->interval_s;
    const double folded = way - there_and_back * std::floor(way / there_and_back);
    const double place = std::clamp(folded <= last ? folded : there_and_back - folded, 0.0, last);
    const std::size_t before = std::min(static_cast<std::size_t>(place), values.size() - 2);
    return Blend(values[before], values[before + 1], place - static_cast<double>(before));
  }

 private:
  std::shared_ptr<const Series> recording_;
  double start_s_;
};

}  // namespace

std::unique_ptr<Path> MakePath(const Options& options, std::uint64_t seed) {
  static const std::map<std::string, double (*)(double) noexcept> fixed = {
      {"sine", Sine},
      {"slow_triangle", SlowTriangle},
      {"fast_taps", FastTaps},
      {"step_hold", StepHold},
      {"taps_of_depths", TapsOfDepths},
      {"contact_chirp", ContactChirp},
      {"free_air_chirp", FreeAirChirp},
      {"free_air", FreeAir},
  };
  const std::string& program = options.Choice("program");
  const std::shared_ptr<const Series>& recording = options.Recorded("recording");
  if ((program == "recorded") != (recording != nullptr))
    throw std::invalid_argument("motion.program = \"recorded\" and motion.recording, a CSV file, need each other");
  if (recording) return std::make_unique<RecordedPath>(recording, options.Number("recording_start_s"));
  if (program == "rich") return std::make_unique<RichPath>(seed);
  if (program == "strokes") return std::make_unique<StrokesPath>(seed);
  return std::make_unique<FixedPath>(fixed.at(program));
}

}  // namespace armcmc::plant_sim
