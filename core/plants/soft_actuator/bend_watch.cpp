#include "plants/soft_actuator/bend_watch.hpp"

#include <algorithm>
#include <cmath>

#include "gap_watch/gap_tools.hpp"
#include "plants/soft_actuator/gap_family.hpp"

namespace armcmc {
namespace {

constexpr int kMostStretches = 50;  // that the scale of the noise remembers

}  // namespace

BendWatch::BendWatch(const EstimatorSettings& settings, double rate, const BendPredictor& sensor) noexcept
    : settings_(settings.gap_watch),
      sensor_(sensor),
      motion_(settings.constants),
      block_(BendChecks(), 0),
      judge_(BendChecks(), rate) {
  Reset();
}

void BendWatch::Reset() noexcept {
  judge_.Reset(settings_.enabled);
  block_.Clear();
  last_seq_ = last_run_ = 0;
  noise_square_ = largest_ = 0.0;
  stretches_ = count_ = 0;
  rows_.num_samples = 0;
  follows_ = false;
}

std::string_view BendWatch::CheckName(int check) const noexcept {
  const int own = check - BendChecks().first;
  return own >= 0 && own < BendChecks().size() ? BendChecks().name(own) : "";
}

void BendWatch::Start(const DataPack& pack, double pressure) noexcept {
  bend_ = {pack.y[0], 0.0};
  pressure_ = pressure;
  since_start_s_ = 0.0;
  rows_.num_samples = 0;
  follows_ = false;
  if (pack.run_id != last_run_ || pack.seq <= last_seq_) {
    // A block knows one run of one plant, in order.
    block_.Clear();
    count_ = 0;
  }
}

void BendWatch::Step(const DataPack& pack, const ShownEstimates& shown) noexcept {
  if (!settings_.enabled) return;
  const double first_s = pack.t_last_s - (pack.num_samples - 1) * pack.dt;
  const auto pressure = [&](int n) noexcept {
    const auto& u = pack.u[At(n)];
    const int valve = u[0] != 0.0 ? 0 : (u[1] != 0.0 ? 1 : 2);
    return sensor_.TruePressure(u[2], first_s + n * pack.dt, valve, shown);
  };
  const bool continues = last_seq_ > 0 && pack.seq == last_seq_ + pack.seq_step && pack.run_id == last_run_ &&
                         pack.dt == motion_.interval();
  motion_.SetInterval(pack.dt);
  if (!continues) Start(pack, pressure(0));
  last_seq_ = pack.seq;
  last_run_ = pack.run_id;
  for (int n = 0; n < pack.num_samples; ++n) {
    const double now = pressure(n);
    if (n > 0 || continues) bend_ = motion_.Next(bend_, pressure_, now);
    pressure_ = now;
    largest_ = std::max(largest_, std::fabs(bend_.angle));
    since_start_s_ += pack.dt;
    if (!std::isfinite(bend_.angle) || !std::isfinite(bend_.rate)) {
      last_seq_ = 0;  // start anew with the next pack
      return;
    }
    if (since_start_s_ < kSettle) continue;
    if (rows_.num_samples == 0 && count_ == 0) {
      first_seq_ = pack.seq;
      begin_s_ = first_s + n * pack.dt;
    }
    Add(pack.y[At(n)] - bend_.angle, now);
    if (rows_.num_samples == kMaxPackSamples) EndStretch(pack);
  }
  if (rows_.num_samples * pack.dt >= kShortestPack * (1.0 - 1e-9)) EndStretch(pack);
}

void BendWatch::Add(double error, double pressure) noexcept {
  const std::size_t n = At(rows_.num_samples++);
  rows_.used[n] = true;
  rows_.error[n] = error;
  rows_.output[n] = bend_.angle;
  regions_[kBending][n] = 1.0;
  regions_[kBendDirection][n] = Sign(bend_.rate);
  regions_[kBendSpeed][n] = bend_.rate;
  regions_[kBendAngle][n] = bend_.angle;
  regions_[kBendLargeAngle][n] = std::fabs(bend_.angle) > kDeep * largest_ ? 1.0 : 0.0;
  regions_[kBendAcceleration][n] = motion_.Acceleration(bend_, pressure);
}

double BendWatch::Scale() noexcept {
  const int n = rows_.num_samples;
  double square = 0.0;
  for (int i = 1; i < n; ++i) square += std::pow(rows_.error[At(i)] - rows_.error[At(i - 1)], 2.0);
  if (n > 1) {
    stretches_ = std::min(stretches_ + 1, kMostStretches);
    noise_square_ += (0.5 * square / (n - 1) - noise_square_) / stretches_;
  }
  // What is tolerated is a share of this scale.
  const double floor = settings_.tolerance > 0.0 ? kResolution * largest_ / settings_.tolerance : 0.0;
  return std::max({std::sqrt(std::max(noise_square_, 0.0)), floor, 1e-300});
}

void BendWatch::EndStretch(const DataPack& pack) noexcept {
  const double scale = Scale();
  for (int i = 0; i < rows_.num_samples; ++i) {
    rows_.error[At(i)] /= scale;
    rows_.output[At(i)] /= scale;
  }
  block_.AddRegions(count_, rows_, 0.0, false, regions_, follows_);
  follows_ = true;
  rows_.num_samples = 0;
  if (++count_ == kGapBlockPacks) EndBlock(pack);
}

void BendWatch::EndBlock(const DataPack& pack) noexcept {
  std::array<CheckScore, kMaxGapChecks> scores{};
  block_.BeginScores();
  for (int c = 0; c < BendChecks().size(); ++c) scores[At(c)] = block_.Score(c, settings_.tolerance);
  judge_.Add(scores, block_, {first_seq_, pack.seq, (pack.t_last_s - begin_s_) / 3600.0});
  block_.Clear();
  count_ = 0;
  follows_ = false;
}

}  // namespace armcmc
