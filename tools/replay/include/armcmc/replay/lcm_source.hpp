#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/model.hpp"
#include "armcmc/replay/draw_record.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/support/lcm_log.hpp"

namespace armcmc::replay {

/// Plant of the first pack of an LCM log. @throws support::InputError when it holds no pack.
[[nodiscard]] const ModelInfo& ModelOfLog(const std::filesystem::path& path, const std::string& prefix);

/// Name of the plant of the first pack of an LCM log, where a file describes it; empty where a compiled plant's packs
/// are there too, or none of either.
[[nodiscard]] std::string DescribedPlantOfLog(const std::filesystem::path& path, const std::string& prefix);

/// Packs from the PLANT_PACK events of an LCM log, or the PLANT_PACK_V2 events of a plant that a file describes,
/// checked and sequenced by the code of the real-time process.
///
/// With a draw record, packs that the recorded run made no estimate from are left out: it was not running
/// yet, or had dropped them.
class LcmSource final : public PackSource {
 public:
  LcmSource(const SourceRequest& request, std::optional<DrawRecord> record);
  ~LcmSource() override;

  bool Next(RecordedPack* next) override;
  [[nodiscard]] PackCounts counts() const override;
  [[nodiscard]] std::vector<std::string> notes() const override;
  [[nodiscard]] double progress() const override { return log_.progress(); }
  [[nodiscard]] support::LcmLogDamage damage() const override { return log_.damage(); }

 private:
  struct Checks;  // codec and sequence tracker of the real-time process, and what they found
  std::string channel_;
  support::LcmLogReader log_;
  std::optional<DrawRecord> record_;
  std::unique_ptr<Checks> checks_;
  std::int64_t unused_ = 0;
};

}  // namespace armcmc::replay
