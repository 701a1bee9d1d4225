#include "armcmc/replay/csv_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "armcmc/models/registry.hpp"
#include "armcmc/support/median_step.hpp"
#include "armcmc/support/pack_length.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::replay {
namespace {

constexpr std::int64_t kRunId = 1;

/// Column order of the result: t, inputs in the order of DataPack::u, output.
support::CsvRequest Columns(const SourceRequest& request) {
  if (request.described != nullptr) {
    const PlantDescription& plant = request.described->plant().description();
    support::CsvRequest columns{{"t"}, {}, request.skip_bad};
    for (const SignalDescription& signal : plant.signals) {
      if (signal.name != plant.output) columns.columns.push_back(signal.name);
      if (!signal.derivative_of.empty()) columns.derived.push_back({signal.name, signal.derivative_of});
    }
    columns.columns.push_back(plant.output);
    return columns;
  }
  const ModelInfo& model = *ModelOf(request.plant);
  support::CsvRequest columns{{"t"}, {}, request.skip_bad};
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.num_inputs); ++i) {
    const SignalInfo& signal = model.compiled->inputs[i];
    columns.columns.emplace_back(signal.name);
    if (!signal.derivative_of.empty())
      columns.derived.push_back({std::string(signal.name), std::string(signal.derivative_of)});
  }
  columns.columns.emplace_back(model.compiled->output.name);
  return columns;
}

/// The decimal number that was meant: times are written in decimals, and their differences are not.
double Snapped(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return std::strtod(text.data(), nullptr);
}

}  // namespace

CsvSource::CsvSource(const SourceRequest& request, std::optional<DrawRecord> record)
    : plant_(request.plant),
      // An output that is simulated over time needs every sample before it; one that is the law does not.
      takes_gaps_(request.described != nullptr
                      ? !request.described->has_memory() && request.described->states().size() == 0
                      : ModelOf(request.plant)->compiled->law_is_output),
      samples_(support::ReadCsv(request.data, Columns(request))),
      record_(std::move(record)),
      row_(request.described != nullptr ? 0 : 1) {
  if (samples_.num_rows() < 2)
    throw support::InputError(request.data.string() + ": one row is too few, the sample interval is unknown");
  if (request.described != nullptr) fingerprint_ = request.described->plant().fingerprint();
  NumberSamples(request);
  if (number_.back() >= samples_per_pack_) last_pack_ = (number_.back() - samples_per_pack_) / stride_ + 1;
  if (last_pack_ == 0)
    throw support::InputError(request.data.string() + ": " + std::to_string(number_.size()) +
                              " rows do not fill a pack; expected " +
                              (row_ > 0 ? "sample 0 and at least " : "at least ") + std::to_string(samples_per_pack_) +
                              (row_ > 0 ? " more" : ""));
}

void CsvSource::NumberSamples(const SourceRequest& request) {
  const std::vector<double>& t = samples_.columns.front();
  const double step = support::MedianStep(t);
  number_.resize(t.size());
  number_[0] = row_ > 0 ? 0 : 1;
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double steps = std::round((t[i] - t[i - 1]) / step);
    number_[i] = number_[i - 1] + static_cast<std::int64_t>(std::clamp(steps, 1.0, 1e12));
  }
  dt_ = Snapped((t.back() - t.front()) / static_cast<double>(number_.back() - number_[0]));
  const int most = kMaxPackSamples / request.overlap;
  if (request.period == 0.0) {
    stride_ = support::SuitablePackLength(dt_, most);
    samples_per_pack_ = stride_ * request.overlap;
    return;
  }
  const double ratio = request.period / dt_;
  stride_ = std::llround(std::min(ratio, 1e6));
  samples_per_pack_ = stride_ * request.overlap;
  if (stride_ < 1 || stride_ > most || std::fabs(ratio - std::round(ratio)) > 1e-3 * ratio)
    throw support::InputError(
        request.data.string() + ": is sampled every " + support::ExactNumber(dt_) +
        " s, which does not divide timing.period_ms = " + support::ExactNumber(request.period * 1e3) + " into 1 to " +
        std::to_string(most) + " samples; change timing.period_ms" + (request.overlap > 1 ? " or timing.overlap" : ""));
}

void CsvSource::Fill(std::size_t end_row, DataPack* pack, std::array<double, kMaxPackSamples>* t) const {
  const std::size_t num_inputs = samples_.columns.size() - 2;
  pack->seq = pack_;
  pack->run_id = kRunId;
  pack->t_last_s = samples_.columns.front()[end_row - 1];
  pack->t_last_ns = static_cast<Nanos>(std::llround(pack->t_last_s * 1e9));
  pack->dt = dt_;
  pack->plant = plant_;
  pack->fingerprint = fingerprint_;
  pack->num_samples = static_cast<int>(end_row - row_);
  pack->num_inputs = static_cast<int>(num_inputs);
  for (std::size_t row = row_; row < end_row; ++row) {
    const std::size_t n = row - row_;
    (*t)[n] = samples_.columns.front()[row];
    pack->y[n] = samples_.columns.back()[row];
    for (std::size_t i = 0; i < num_inputs; ++i) pack->u[n][i] = samples_.columns[i + 1][row];
  }
}

void CsvSource::SkipEmptyPacks() {
  if (row_ >= number_.size()) return;
  // The first pack that reaches up to the next row.
  const std::int64_t beyond = std::max<std::int64_t>(number_[row_] - samples_per_pack_, 0);
  const std::int64_t filled = (beyond + stride_ - 1) / stride_ + 1;
  const std::int64_t before = std::min(filled, last_pack_) - 1;
  if (before <= pack_) return;
  counts_.lost += before - pack_;
  pack_ = before;
}

bool CsvSource::Next(RecordedPack* next) {
  while (pack_ < last_pack_) {
    SkipEmptyPacks();
    ++pack_;
    std::size_t end_row = row_;
    while (end_row < number_.size() && number_[end_row] <= (pack_ - 1) * stride_ + samples_per_pack_) ++end_row;
    const auto missing = samples_per_pack_ - static_cast<std::int64_t>(end_row - row_);
    const bool usable = missing == 0 || (missing < samples_per_pack_ && takes_gaps_);
    if (usable) Fill(end_row, &next->pack, &next->t);
    while (row_ < number_.size() && number_[row_] <= pack_ * stride_) ++row_;
    if (!usable) {
      ++counts_.lost;
      continue;
    }
    next->limits = kNoDrawLimits;
    if (record_) {
      const std::optional<DrawLimits> limits = record_->Find(0, pack_);
      if (!limits) {
        ++counts_.unused;
        continue;
      }
      next->limits = *limits;
    }
    if (missing > 0) ++incomplete_;
    return true;
  }
  return false;
}

std::vector<std::string> CsvSource::notes() const {
  std::vector<std::string> notes = samples_.notes;
  if (incomplete_ > 0) notes.push_back(std::to_string(incomplete_) + " packs are used although samples are missing");
  if (const std::int64_t left = (number_.back() - samples_per_pack_) % stride_; left > 0)
    notes.push_back("the last " + std::to_string(left) + " samples do not fill a pack and are left out");
  return notes;
}

double CsvSource::progress() const { return static_cast<double>(pack_) / static_cast<double>(last_pack_); }

}  // namespace armcmc::replay
