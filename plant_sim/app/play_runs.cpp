#include "play_runs.hpp"

#include <armcmc/support/printable.hpp>
#include <armcmc/support/program.hpp>
#include <armcmc/support/progress.hpp>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>

#include "armcmc/plant_sim/lcm_link.hpp"
#include "armcmc/plant_sim/lcm_log_writer.hpp"
#include "armcmc/plant_sim/monotonic_clock.hpp"
#include "armcmc/plant_sim/playback.hpp"
#include "interruption.hpp"
#include "run_id.hpp"

namespace armcmc::plant_sim {
namespace {

std::string Counted(std::int64_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace

void CheckStride(int stride, int samples_per_pack) {
  if (stride != 0 && samples_per_pack % stride != 0)
    throw support::InputError("a pack every " + std::to_string(stride) +
                              " samples (--stride, pack_stride): expected a " + "divisor of the " +
                              std::to_string(samples_per_pack) + " samples of a pack");
}

int PlayRuns(const SampleRuns& runs, const std::string& title, int samples_per_pack, double speed,
             const PlantOptions& options) {
  CheckStride(options.stride, samples_per_pack);
  DescribedPackBuilder builder(runs, samples_per_pack, MakeRunId(), options.stride);
  const std::int64_t planned = builder.num_packs();
  if (planned == 0)
    throw support::InputError(title + ": no run has the " + std::to_string(samples_per_pack) + " samples of a pack");
  CatchSignals();
  LcmSink bus(options.lcm_url);
  std::optional<LcmLogWriter> log;
  if (!options.log_path.empty()) log.emplace(options.log_path);
  DescribedPackSender sender(options.prefix, &bus, log ? &*log : nullptr);

  std::printf("%s: %s of %d samples of %s, one every %g ms, on %s\n", support::Printable(title).c_str(),
              Counted(planned, "pack").c_str(), samples_per_pack, support::Printable(runs.plant).c_str(),
              builder.pack_period_s() / speed * 1e3, options.lcm_url.c_str());
  std::fflush(stdout);
  PlaybackResult result;
  {
    support::Progress progress(title);
    result = Play(&builder, &sender, MonotonicNow() + kStartDelay, speed, [&](std::int64_t sent) {
      progress.Update(static_cast<double>(sent) / static_cast<double>(planned));
      return Interrupted();
    });
  }
  std::printf("%lld of %s sent, %s, %lld late; %s at the ends of runs fill no pack and are left out%s\n",
              static_cast<long long>(result.packs_sent), Counted(planned, "pack").c_str(),
              Counted(static_cast<std::int64_t>(runs.runs.size()), "run").c_str(),
              static_cast<long long>(result.packs_late),
              Counted(static_cast<std::int64_t>(builder.left_out()), "sample").c_str(),
              result.packs_sent < planned ? ". Stopped early" : "");
  if (log && log->errors() > 0)
    throw std::runtime_error(options.log_path + ": could not be written completely: is the disk full?");
  if (sender.errors() > 0)
    throw std::runtime_error(Counted(sender.errors(), "pack") + " could not be sent: is the multicast route gone?");
  return 0;
}

}  // namespace armcmc::plant_sim
