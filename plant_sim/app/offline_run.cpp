#include "offline_run.hpp"

#include <algorithm>
#include <armcmc/support/printable.hpp>
#include <armcmc/support/progress.hpp>
#include <cstdint>
#include <cstdio>
#include <stdexcept>

#include "armcmc/plant_sim/csv_writer.hpp"
#include "armcmc/plant_sim/lcm_log_writer.hpp"
#include "armcmc/plant_sim/pack_builder.hpp"
#include "armcmc/plant_sim/pack_sender.hpp"

namespace armcmc::plant_sim {
namespace {

void WriteLog(const Scenario& scenario, const PlantOptions& options) {
  LcmLogWriter log(options.log_path);
  PackBuilder builder(scenario, options.seed, static_cast<std::int64_t>(options.seed));
  PackSender sender(options.prefix, options.faults, &log);
  for (std::int64_t k = 1; k <= scenario.num_packs(); ++k) {
    if (!builder.Next()) throw std::runtime_error("the plant left the finite range: check the scenario's parameters");
    builder.Stamp(scenario.end_of_pack_ns(k), scenario.end_of_pack_ns(k) / 1000);
    sender.Send(builder.pack(), builder.truth());
  }
  sender.Flush();
  if (log.errors() > 0) throw std::runtime_error(options.log_path + ": cannot be written: is the disk full?");
}

}  // namespace

int RunOffline(const Scenario& scenario, const PlantOptions& options) {
  const long long last = scenario.last_sample(scenario.num_packs());
  CsvWriter csv(scenario, options.seed, options.csv_path);
  support::Progress progress(scenario.name);
  constexpr long long kChunk = 10'000;
  for (long long index = 0; index < last; index += kChunk) {
    csv.WriteThrough(std::min(index + kChunk, last));
    progress.Update(static_cast<double>(index) / static_cast<double>(last));
  }
  csv.Close();
  if (!options.log_path.empty()) WriteLog(scenario, options);
  std::printf("%s: samples 0 to %lld (%lld packs of %d) written to %s\n", support::Printable(scenario.name).c_str(),
              last, scenario.num_packs(), scenario.pack_samples, support::Escaped(options.csv_path).c_str());
  return 0;
}

}  // namespace armcmc::plant_sim
