#include "armcmc/replay/draw_record.hpp"

#include <algorithm>

#include "armcmc/estimate_t.hpp"
#include "armcmc/support/csv.hpp"
#include "armcmc/support/lcm_log.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::replay {
namespace {

DrawLimits LimitsOf(const estimate_t& estimate) {
  DrawLimits limits = kNoDrawLimits;
  // No draws at all: the pack was held, which the repetition will find again by itself.
  for (std::size_t mode = 0; mode < limits.size(); ++mode)
    if (estimate.draws_by_mode[mode] > 0) limits[mode] = estimate.draws_by_mode[mode];
  return limits;
}

}  // namespace

DrawRecord DrawRecord::FromLog(const std::filesystem::path& path, const std::string& prefix) {
  DrawRecord record;
  support::LcmLogReader log(path);
  support::LcmLogEvent event;
  const std::string channel = prefix + "EST_ESTIMATE";
  estimate_t estimate{};
  while (log.Next(&event)) {
    if (event.channel != channel) continue;
    if (estimate.decode(event.data.data(), 0, static_cast<int>(event.data.size())) < 0) continue;
    record.limits_[{estimate.run_id, estimate.seq}] = LimitsOf(estimate);
  }
  return record;
}

DrawRecord DrawRecord::FromCsv(const std::filesystem::path& path, const std::vector<std::string>& mode_names) {
  support::CsvRequest request;
  request.columns = {"pack"};
  for (const std::string& mode : mode_names)
    request.columns.push_back(mode_names.size() == 1 ? "draws" : "draws_" + mode);
  const support::CsvSamples samples = support::ReadCsv(path, request);
  DrawRecord record;
  record.any_run_ = true;
  for (std::size_t row = 0; row < samples.num_rows(); ++row) {
    DrawLimits limits = kNoDrawLimits;
    for (std::size_t mode = 0; mode < mode_names.size(); ++mode) {
      // No draws at all: the pack was held, which the repetition will find again by itself.
      const double draws = samples.columns[mode + 1][row];
      if (draws > 0.0) limits[mode] = static_cast<int>(std::min(draws, static_cast<double>(kMaxDraws)));
    }
    record.limits_[{0, static_cast<std::int64_t>(samples.columns[0][row])}] = limits;
  }
  return record;
}

std::optional<DrawLimits> DrawRecord::Find(std::int64_t run_id, std::int64_t seq) const {
  const auto found = limits_.find({any_run_ ? 0 : run_id, seq});
  if (found == limits_.end()) return std::nullopt;
  return found->second;
}

void DrawRecord::ForgetRuns(const std::filesystem::path& path) {
  std::map<Key, DrawLimits> without;
  for (const auto& [key, limits] : limits_) {
    if (key.first != limits_.begin()->first.first)
      throw support::InputError(path.string() + ": holds estimates of several runs of the plant, the data are of one");
    without[{0, key.second}] = limits;
  }
  limits_ = std::move(without);
  any_run_ = true;
}

}  // namespace armcmc::replay
