#include "recording_run.hpp"

#include <armcmc/support/pack_length.hpp>
#include <armcmc/support/printable.hpp>
#include <armcmc/support/recording.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>

#include "armcmc/data_pack_v2_t.hpp"
#include "play_runs.hpp"

namespace armcmc::plant_sim {

int RunRecording(const std::string& path, const std::string& data_dir, double speed, const PlantOptions& options) {
  support::Recording recording = support::ReadRecording(path, data_dir);
  for (const std::string& note : recording.notes)
    std::fprintf(stderr, "armcmc-plant: %s\n", support::ErrorLine(note).c_str());
  SampleRuns runs;
  runs.plant = recording.plant;
  runs.fingerprint = recording.fingerprint;
  runs.output = recording.output;
  runs.dt = recording.dt;
  runs.runs = recording.runs;
  for (support::RecordedSignal& signal : recording.signals)
    runs.signals.push_back({std::move(signal.name), std::move(signal.unit), std::move(signal.value)});
  const std::string title = recording.title.empty() ? std::filesystem::path(path).filename().string() : recording.title;
  return PlayRuns(runs, title, support::SuitablePackLength(recording.dt, data_pack_v2_t::MAX_SAMPLES), speed, options);
}

}  // namespace armcmc::plant_sim
