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

bool IsLcmLog(const std::filesystem::path& path) {
  if (path.extension() == ".lcm" || path.extension() == ".lcmlog") return true;
  std::array<char, 4> start{};
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), start.size());
  return file && start == std::array<char, 4>{'\xED', '\xA1', '\xDA', '\x01'};
}

std::unique_ptr<PackSource> OpenSource(const SourceRequest& request) {
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

}  // namespace armcmc::replay
