#include "armcmc/plant_sim/described_pack_builder.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace armcmc::plant_sim {
namespace {

/// Zero padded; what does not fit is cut.
template <typename Byte, std::size_t kSize>
void CopyText(const std::string& text, Byte (&field)[kSize]) {
  for (std::size_t i = 0; i < std::min(text.size(), kSize); ++i) field[i] = static_cast<Byte>(text[i]);
}

void CheckSizes(const SampleRuns& runs, int samples_per_pack, int stride) {
  const std::size_t inputs = runs.signals.empty() ? 0 : runs.signals.size() - 1;
  if (inputs < 1 || inputs > static_cast<std::size_t>(data_pack_v2_t::MAX_INPUTS) || runs.output > inputs)
    throw std::invalid_argument(runs.plant + ": has " + std::to_string(inputs) +
                                " signals beside its output; a pack takes 1 to " +
                                std::to_string(data_pack_v2_t::MAX_INPUTS));
  if (samples_per_pack < 1 || samples_per_pack > data_pack_v2_t::MAX_SAMPLES)
    throw std::invalid_argument(runs.plant + ": packs of " + std::to_string(samples_per_pack) +
                                " samples; a pack takes 1 to " + std::to_string(data_pack_v2_t::MAX_SAMPLES));
  if (stride < 1 || samples_per_pack % stride != 0)
    throw std::invalid_argument(runs.plant + ": a pack every " + std::to_string(stride) +
                                " samples; expected a divisor of the " + std::to_string(samples_per_pack) +
                                " samples of a pack");
  if (!(runs.dt > 0.0) || !std::isfinite(runs.dt))
    throw std::invalid_argument(runs.plant + ": a sample interval of " + std::to_string(runs.dt) + " s");
  for (const SignalSamples& signal : runs.signals)
    if (signal.value.size() != runs.num_rows())
      throw std::invalid_argument(runs.plant + ": " + signal.name + " has " + std::to_string(signal.value.size()) +
                                  " samples, " + runs.signals.front().name + " has " + std::to_string(runs.num_rows()));
  if (!std::is_sorted(runs.runs.begin(), runs.runs.end()) || (!runs.runs.empty() && runs.runs.back() > runs.num_rows()))
    throw std::invalid_argument(runs.plant + ": its runs do not follow one another");
}

}  // namespace

DescribedPackBuilder::DescribedPackBuilder(const SampleRuns& runs, int samples_per_pack, std::int64_t run_id,
                                           int stride)
    : runs_(runs),
      samples_(static_cast<std::size_t>(std::max(samples_per_pack, 1))),
      stride_(stride == 0 ? samples_ : static_cast<std::size_t>(std::max(stride, 1))) {
  CheckSizes(runs, samples_per_pack, stride == 0 ? samples_per_pack : stride);
  pack_.run_id = run_id;
  pack_.dt = runs.dt;
  pack_.fingerprint = static_cast<std::int64_t>(runs.fingerprint);
  pack_.n_samples = samples_per_pack;
  pack_.n_inputs = static_cast<std::int32_t>(runs.signals.size()) - 1;
  CopyText(runs.plant, pack_.plant);
  std::size_t column = 0;
  for (std::size_t s = 0; s < runs.signals.size(); ++s) {
    const bool is_output = s == runs.output;
    CopyText(runs.signals[s].name, is_output ? pack_.y_name : pack_.u_name[column]);
    CopyText(runs.signals[s].unit, is_output ? pack_.y_unit : pack_.u_unit[column]);
    if (!is_output) ++column;
  }
  for (std::size_t run = 0; run < runs.runs.size(); ++run) {
    const std::size_t length = runs.RunEnd(run) - runs.runs[run];
    const bool fills = length >= samples_;
    num_packs_ += fills ? static_cast<std::int64_t>((length - samples_) / stride_ + 1) : 0;
    left_out_ += fills ? (length - samples_) % stride_ : length;
  }
  if (!runs.runs.empty()) row_ = runs.runs.front();
}

bool DescribedPackBuilder::Next() noexcept {
  while (run_ < runs_.runs.size() && row_ + samples_ > runs_.RunEnd(run_)) {
    ++run_;
    if (run_ == runs_.runs.size()) break;
    row_ = runs_.runs[run_];
    pack_.seq = 0;
    ++pack_.run_id;
  }
  if (run_ >= runs_.runs.size()) return false;
  ++pack_.seq;
  std::size_t column = 0;
  for (std::size_t s = 0; s < runs_.signals.size(); ++s) {
    const double* values = runs_.signals[s].value.data() + row_;
    if (s == runs_.output) {
      std::copy(values, values + samples_, pack_.y);
      continue;
    }
    for (std::size_t n = 0; n < samples_; ++n) pack_.u[n][column] = values[n];
    ++column;
  }
  pack_.t_last_s = static_cast<double>(row_ + samples_ - 1 - runs_.runs[run_]) * runs_.dt;
  row_ += stride_;
  return true;
}

void DescribedPackBuilder::Stamp(std::int64_t t_last_ns, std::int64_t utime) noexcept {
  pack_.t_last_ns = t_last_ns;
  pack_.pack_utime = utime;
}

}  // namespace armcmc::plant_sim
