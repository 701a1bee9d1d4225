// Snapshots: the file, and, past its checksum, the content, which then has to bear a step.
#include <cmath>
#include <cstdint>
#include <memory>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/rt/warm_up.hpp"
#include "armcmc/snapshot.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "snapshot_file.hpp"

namespace {

struct Bench {
  static armcmc::EstimatorSettings Settings() {
    auto settings = armcmc::BuiltinSettings("hunt_crossley");
    settings.sampler.rule = armcmc::DrawRule::kFixed;
    settings.sampler.fixed_draws = settings.sampler.max_draws = 600;
    settings.gap_watch.enabled = false;
    return settings;
  }
  armcmc::Estimator estimator{Settings()};
  std::unique_ptr<armcmc::AdjustResult> result = estimator.MakeResult();
  armcmc::Estimate estimate;
  armcmc::DataPack pack = armcmc::rt::SyntheticPack({armcmc::HuntCrossley::kInfo.plant, 2}, 100);
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto bench = std::make_unique<Bench>();
  const std::uint64_t identity = armcmc::SnapshotIdentity(bench->estimator.settings());
  const auto bytes = std::as_bytes(std::span(data, size));
  armcmc::app::Snapshot snapshot;
  (void)armcmc::app::DecodeSnapshot(bytes, identity, &snapshot);

  constexpr std::size_t kHeader = 48;
  if (size < kHeader) return 0;
  // The same bytes as if the checksum were right: sizes from the header, as far as they fit.
  std::uint32_t first = 0;
  std::memcpy(&first, data + 12, sizeof first);
  const auto parts = bytes.subspan(kHeader);
  const std::size_t split = std::min<std::size_t>(first, parts.size());
  const std::size_t end = parts.size() >= split + 8 ? parts.size() - 8 : parts.size();
  if (!bench->estimator.Restore(parts.first(split), parts.subspan(split, end - split))) return 0;
  (void)bench->estimator.Adjust(bench->pack, 0, armcmc::ClockRef{}, bench->result.get());
  bench->estimator.Execute(*bench->result, &bench->estimate);
  return 0;
}
