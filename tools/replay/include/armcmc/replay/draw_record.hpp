#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/estimator.hpp"

namespace armcmc::replay {

/// How many draws a run made at each pack. A deadline may have cut some; a repetition that cuts at the same
/// number is bit-identical.
class DrawRecord {
 public:
  /// From the EST_ESTIMATE events of a log. Empty when the log has none.
  static DrawRecord FromLog(const std::filesystem::path& path, const std::string& prefix);
  /// From an estimate CSV: column draws, or draws_MODE for plants with several modes.
  static DrawRecord FromCsv(const std::filesystem::path& path, const std::vector<std::string>& mode_names);

  [[nodiscard]] bool empty() const { return limits_.empty(); }
  [[nodiscard]] std::size_t size() const { return limits_.size(); }
  /// @return nothing when the run made no estimate from that pack.
  [[nodiscard]] std::optional<DrawLimits> Find(std::int64_t run_id, std::int64_t seq) const;
  /// For recordings without runs. @throws support::InputError when the record holds several runs of the plant.
  void ForgetRuns(const std::filesystem::path& path);

 private:
  using Key = std::pair<std::int64_t, std::int64_t>;  // run_id, seq
  bool any_run_ = false;                              // run_id is not known: every key has 0
  std::map<Key, DrawLimits> limits_;
};

}  // namespace armcmc::replay
