#pragma once

#include <optional>

#include "armcmc/replay/draw_record.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::replay {

/// Packs of a recording of a described plant, cut run by run: pack k of a run holds its samples (k-1) S .. (k-1) S + N
/// - 1, N = S overlap, as when the recording is played onto a bus. What does not fill a pack at the end of a run is
/// left out.
class RecordingSource final : public PackSource {
 public:
  /// @pre request.recording, request.described.
  /// @throws support::InputError where no run fills a pack.
  RecordingSource(const SourceRequest& request, std::optional<DrawRecord> record);

  bool Next(RecordedPack* next) override;
  [[nodiscard]] PackCounts counts() const override { return counts_; }
  [[nodiscard]] std::vector<std::string> notes() const override;
  [[nodiscard]] double progress() const override;

 private:
  [[nodiscard]] std::size_t RunEnd() const;
  void Fill(RecordedPack* next) const;

  std::shared_ptr<const support::Recording> recording_;
  std::optional<DrawRecord> record_;
  std::size_t samples_per_pack_ = 0, stride_ = 0;
  std::size_t run_ = 0;
  std::size_t row_ = 0;
  std::int64_t pack_ = 0;  ///< Of the run, the last one handed out.
  PackCounts counts_;
};

}  // namespace armcmc::replay
