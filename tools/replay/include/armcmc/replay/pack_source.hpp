#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/plant/program.hpp"
#include "armcmc/support/lcm_log.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::replay {

/// One recorded pack and how far the run that it came from drew.
struct RecordedPack {
  DataPack pack;
  DrawLimits limits = kNoDrawLimits;
  std::array<double, kMaxPackSamples> t{};  ///< s, time of every sample.
};

/// What happened to the packs of a recording.
struct PackCounts {
  std::int64_t lost = 0;
  std::int64_t duplicate = 0;
  std::int64_t reordered = 0;
  std::int64_t rejected = 0;  ///< Failed the checks of the real-time process.
  std::int64_t unused = 0;    ///< Valid, but the live run made no estimate from them.
};

/// The packs of a recording, in the order in which they are to be used.
class PackSource {
 public:
  virtual ~PackSource() = default;
  /// The next valid pack. @return false at the end.
  virtual bool Next(RecordedPack* next) = 0;
  [[nodiscard]] virtual PackCounts counts() const = 0;
  /// What a person should know. Complete at the end.
  [[nodiscard]] virtual std::vector<std::string> notes() const = 0;
  /// Share read so far, in [0, 1].
  [[nodiscard]] virtual double progress() const = 0;
  /// What an LCM log has lost. Complete at the end.
  [[nodiscard]] virtual support::LcmLogDamage damage() const { return {}; }
};

/// What to replay.
struct SourceRequest {
  std::filesystem::path data;  ///< CSV of samples, or LCM log: told apart by content.
  PlantNumber plant = PlantNumber::kNone;
  int num_inputs = 2;
  std::shared_ptr<const PlantProgram> described;        ///< Of a plant that a file describes.
  std::shared_ptr<const support::Recording> recording;  ///< Of such a plant, instead of `data`; null: none.
  double period = 0.1;                                  ///< s, T_s between packs: a CSV is cut so; 0: as suits it.
  int overlap = 1;                   ///< EstimatorSettings::overlap: a pack of a CSV spans so many periods.
  bool one_recursion = false;        ///< Every overlap-th pack alone: for one Estimator, which counts a sample once.
  bool skip_bad = false;             ///< CSV: count and skip bad rows.
  std::string prefix;                ///< LCM: of the channel names.
  std::filesystem::path draws_from;  ///< Estimates of the run to repeat, CSV or LCM log; empty: those in the data.
  bool repeat_draws = true;          ///< false: another computation than the recorded one; no number of draws is taken.
  std::vector<std::string> mode_names;
};

/// @throws support::InputError naming file, line and what was expected.
[[nodiscard]] std::unique_ptr<PackSource> OpenSource(const SourceRequest& request);

/// True when the file starts like an LCM log or is called .lcm or .lcmlog.
[[nodiscard]] bool IsLcmLog(const std::filesystem::path& path);

}  // namespace armcmc::replay
