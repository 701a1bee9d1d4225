#include "armcmc/replay/pack_source.hpp"

#include <array>
#include <fstream>
#include <optional>
#include <utility>

#include "armcmc/replay/csv_source.hpp"
#include "armcmc/replay/draw_record.hpp"
#include "armcmc/replay/lcm_source.hpp"
#include "armcmc/replay/recording_source.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::replay {
namespace {

/// The packs of one recursion.
class OneRecursion final : public PackSource {
 public:
  OneRecursion(std::unique_ptr<PackSource> source, int overlap) : source_(std::move(source)), overlap_(overlap) {}

  bool Next(RecordedPack* next) override {
    while (source_->Next(next))
      if (next->pack.seq % overlap_ == 0) return true;
    return false;
  }
  [[nodiscard]] PackCounts counts() const override { return source_->counts(); }
  [[nodiscard]] std::vector<std::string> notes() const override { return source_->notes(); }
  [[nodiscard]] double progress() const override { return source_->progress(); }
  [[nodiscard]] support::LcmLogDamage damage() const override { return source_->damage(); }

 private:
  std::unique_ptr<PackSource> source_;
  int overlap_;
};

std::unique_ptr<PackSource> OpenWhole(const SourceRequest& request) {
  const bool is_log = request.recording == nullptr && IsLcmLog(request.data);
  std::optional<DrawRecord> record;
  if (!request.draws_from.empty()) {
    record = IsLcmLog(request.draws_from) ? DrawRecord::FromLog(request.draws_from, request.prefix)
                                          : DrawRecord::FromCsv(request.draws_from, request.mode_names);
    if (record->empty())
      throw support::InputError(request.draws_from.string() + ": holds no estimate to take the draws from");
  } else if (is_log && request.repeat_draws) {
    record = DrawRecord::FromLog(request.data, request.prefix);
    if (record->empty()) record.reset();
  }
  if (is_log) return std::make_unique<LcmSource>(request, std::move(record));
  if (request.recording != nullptr) return std::make_unique<RecordingSource>(request, std::move(record));
  if (record) record->ForgetRuns(request.draws_from);
  return std::make_unique<CsvSource>(request, std::move(record));
}

}  // namespace

bool IsLcmLog(const std::filesystem::path& path) {
  if (path.extension() == ".lcm" || path.extension() == ".lcmlog") return true;
  std::array<char, 4> start{};
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), start.size());
  return file && start == std::array<char, 4>{'\xED', '\xA1', '\xDA', '\x01'};
}

std::unique_ptr<PackSource> OpenSource(const SourceRequest& request) {
  std::unique_ptr<PackSource> source = OpenWhole(request);
  if (!request.one_recursion || request.overlap == 1) return source;
  return std::make_unique<OneRecursion>(std::move(source), request.overlap);
}

}  // namespace armcmc::replay
