#pragma once

#include <optional>

#include "armcmc/replay/draw_record.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/support/csv.hpp"

namespace armcmc::replay {

/// Packs from a CSV of samples. The first row is sample 0; pack k holds the samples (k-1) S + 1 .. (k-1) S + N, S =
/// period / dt and N = S overlap. Of a plant that a file describes the first row is sample 1, so that its packs are
/// those that it sends.
///
/// A sample's number follows from its time, so that a row that is missing or was skipped leaves a gap. Such a pack is
/// used with the samples that it has when the model has no memory of those before, else it counts as lost, as does one
/// without samples. Samples behind the last full pack are left out.
class CsvSource final : public PackSource {
 public:
  /// Without a period packs are of 0.1 s where that is 20 samples at least, and of 100 samples where it is fewer.
  /// @throws support::InputError when the file is bad, or the period is not a whole number of samples in
  /// [1, kMaxPackSamples / overlap].
  CsvSource(const SourceRequest& request, std::optional<DrawRecord> record);

  bool Next(RecordedPack* next) override;
  [[nodiscard]] PackCounts counts() const override { return counts_; }
  [[nodiscard]] std::vector<std::string> notes() const override;
  [[nodiscard]] double progress() const override;

 private:
  void NumberSamples(const SourceRequest& request);
  /// Counts the packs without any row as lost, at once: a gap may be as long as it likes.
  void SkipEmptyPacks();
  void Fill(std::size_t end_row, DataPack* pack, std::array<double, kMaxPackSamples>* t) const;

  PlantNumber plant_;
  std::uint64_t fingerprint_ = 0;
  bool takes_gaps_ = false;  // no sample needs those before it
  support::CsvSamples samples_;
  std::optional<DrawRecord> record_;
  double dt_ = 0.0;
  std::int64_t samples_per_pack_ = 0, stride_ = 0;
  std::vector<std::int64_t> number_;  // of each row
  std::size_t row_;
  std::int64_t pack_ = 0;  // the last one read
  std::int64_t last_pack_ = 0;
  std::int64_t incomplete_ = 0;  // packs used although samples are missing
  PackCounts counts_;
};

}  // namespace armcmc::replay
