#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "armcmc/estimate.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::replay {

/// What came out of a comparison with what a live run had published.
struct Verification {
  std::int64_t compared = 0;      ///< Messages: estimates, posteriors, and probabilities of change.
  std::int64_t different = 0;     ///< Of those.
  std::int64_t undecodable = 0;   ///< Messages on the channels of the estimates that are of no type of this version.
  std::int64_t without_pack = 0;  ///< Recorded estimates whose pack the recording has lost.
  std::string first_difference;   ///< In words: pack, channel, field, both values. Empty: none.
  [[nodiscard]] bool equal() const { return compared > 0 && different == 0; }
};

/// Compares a replay with the EST_ESTIMATE, EST_POSTERIOR and EST_CHANGE messages of the same log, byte for byte. What
/// only a clock knows (utime, t_release_ns, t_done_ns) is copied from the log.
class Verifier {
 public:
  /// @param prefix    Of the channel names.
  /// @param settings  Of the replay: names and units of what it reports.
  /// @throws support::InputError when the log holds no estimate.
  Verifier(const std::filesystem::path& log, const std::string& prefix, const EstimatorSettings& settings);
  ~Verifier();
  Verifier(const Verifier&) = delete;
  Verifier& operator=(const Verifier&) = delete;

  /// Compares one estimate of the replay with what was recorded for its pack.
  void Check(const Estimate& estimate);
  /// Call after the last Check().
  [[nodiscard]] Verification Finish() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace armcmc::replay
