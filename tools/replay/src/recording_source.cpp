#include "armcmc/replay/recording_source.hpp"

#include <cmath>
#include <utility>

#include "armcmc/support/pack_length.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::replay {

RecordingSource::RecordingSource(const SourceRequest& request, std::optional<DrawRecord> record)
    : recording_(request.recording), record_(std::move(record)) {
  const support::Recording& r = *recording_;
  const auto overlap = static_cast<std::size_t>(request.overlap);
  stride_ = static_cast<std::size_t>(request.period > 0.0
                                         ? std::lround(std::min(request.period / r.dt, 1e6))
                                         : support::SuitablePackLength(r.dt, kMaxPackSamples / request.overlap));
  samples_per_pack_ = stride_ * overlap;
  if (samples_per_pack_ < 1 || samples_per_pack_ > kMaxPackSamples)
    throw support::InputError(r.title + ": has a sample every " + std::to_string(r.dt) +
                              " s, so that a period does not hold 1 to " + std::to_string(kMaxPackSamples) +
                              " samples; change timing.period_ms");
  bool any = false;
  for (run_ = 0; run_ < r.runs.size(); ++run_) any = any || RunEnd() - r.runs[run_] >= samples_per_pack_;
  run_ = 0;
  if (!any)
    throw support::InputError(r.title + ": no run has the " + std::to_string(samples_per_pack_) + " samples of a pack");
}

std::size_t RecordingSource::RunEnd() const {
  const support::Recording& r = *recording_;
  return run_ + 1 < r.runs.size() ? r.runs[run_ + 1] : r.num_rows();
}

void RecordingSource::Fill(RecordedPack* next) const {
  const support::Recording& r = *recording_;
  const std::size_t first = r.runs[run_];
  DataPack& pack = next->pack;
  pack.seq = pack_;
  pack.run_id = static_cast<std::int64_t>(run_) + 1;
  pack.dt = r.dt;
  pack.plant = PlantNumber::kDescribed;
  pack.fingerprint = r.fingerprint;
  pack.num_samples = static_cast<int>(samples_per_pack_);
  pack.num_inputs = static_cast<int>(r.signals.size()) - 1;
  for (std::size_t n = 0; n < samples_per_pack_; ++n) {
    const std::size_t row = row_ + n;
    next->t[n] = r.t[row];
    for (std::size_t s = 0, column = 0; s < r.signals.size(); ++s) {
      const double value = r.signals[s].value[row];
      if (s == r.output) {
        pack.y[n] = value;
      } else {
        pack.u[n][column++] = value;
      }
    }
  }
  // The plant's time counts from the start of its run.
  pack.t_last_s = static_cast<double>(row_ + samples_per_pack_ - 1 - first) * r.dt;
  pack.t_last_ns = static_cast<Nanos>(std::llround(pack.t_last_s * 1e9));
}

bool RecordingSource::Next(RecordedPack* next) {
  const support::Recording& r = *recording_;
  while (run_ < r.runs.size()) {
    if (row_ + samples_per_pack_ > RunEnd()) {
      ++run_;
      if (run_ < r.runs.size()) row_ = r.runs[run_];
      pack_ = 0;
      continue;
    }
    ++pack_;
    Fill(next);
    row_ += stride_;
    next->limits = kNoDrawLimits;
    if (record_) {
      const std::optional<DrawLimits> limits = record_->Find(next->pack.run_id, pack_);
      if (!limits) {
        ++counts_.unused;
        continue;
      }
      next->limits = *limits;
    }
    return true;
  }
  return false;
}

std::vector<std::string> RecordingSource::notes() const {
  std::vector<std::string> notes = recording_->notes;
  std::size_t left = 0;
  for (std::size_t run = 0; run < recording_->runs.size(); ++run) {
    const std::size_t end = run + 1 < recording_->runs.size() ? recording_->runs[run + 1] : recording_->num_rows();
    const std::size_t length = end - recording_->runs[run];
    left += length < samples_per_pack_ ? length : (length - samples_per_pack_) % stride_;
  }
  if (left > 0)
    notes.push_back(std::to_string(left) + " samples at the ends of runs do not fill a pack and are left out");
  return notes;
}

double RecordingSource::progress() const {
  return static_cast<double>(row_) / static_cast<double>(recording_->num_rows());
}

}  // namespace armcmc::replay
