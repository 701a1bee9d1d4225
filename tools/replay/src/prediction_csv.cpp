#include "armcmc/replay/prediction_csv.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace armcmc::replay {
namespace {

void Append(double value, std::string* row) {
  std::array<char, 32> text{};
  if (std::isfinite(value)) std::snprintf(text.data(), text.size(), "%.17g", value);
  row->append(text.data());
}

}  // namespace

PredictionCsv::PredictionCsv(std::ostream* out, int overlap) : out_(out), overlap_(overlap) {
  *out_ << "t,pack,y,y_shown,y_shown_free_run\n";
}

void PredictionCsv::Write(const RecordedPack& recorded, const Estimate& estimate) {
  const DataPack& pack = recorded.pack;
  const bool goes_on = pack.run_id == last_run_ && pack.seq > last_seq_ && last_seq_ > 0;
  const std::int64_t stride = pack.num_samples / overlap_;
  const std::int64_t fresh =
      goes_on ? std::min<std::int64_t>((pack.seq - last_seq_) * stride, pack.num_samples) : pack.num_samples;
  last_run_ = pack.run_id;
  last_seq_ = pack.seq;
  std::string row;
  for (auto n = static_cast<std::size_t>(pack.num_samples - fresh); n < static_cast<std::size_t>(pack.num_samples);
       ++n) {
    row.clear();
    Append(recorded.t[n], &row);
    row.append(",").append(std::to_string(estimate.seq)).append(",");
    Append(recorded.pack.y[n], &row);
    row.append(",");
    Append(estimate.y_shown[n], &row);
    row.append(",");
    Append(estimate.y_shown_free_run[n], &row);
    *out_ << row << '\n';
  }
}

}  // namespace armcmc::replay
