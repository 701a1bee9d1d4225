#include "armcmc/replay/prediction_csv.hpp"

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

PredictionCsv::PredictionCsv(std::ostream* out) : out_(out) { *out_ << "t,pack,y,y_shown,y_shown_free_run\n"; }

void PredictionCsv::Write(const RecordedPack& recorded, const Estimate& estimate) {
  std::string row;
  for (std::size_t n = 0; n < static_cast<std::size_t>(recorded.pack.num_samples); ++n) {
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
