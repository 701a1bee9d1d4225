#include "session.hpp"

#include <stdexcept>

#include "armcmc/support/estimator_config.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/shared_files.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::replay {

Session ReadSession(const std::string& config, const std::string& model, const std::optional<std::uint64_t>& seed) {
  Session session;
  if (!config.empty()) session.config = support::FindSharedFile("config", config);
  auto root = config.empty() ? support::StrictTable::FromText("schema = 1\n", "the configuration")
                             : support::StrictTable::FromFile(session.config);
  session.settings = support::ReadEstimatorSettings(root, model);
  support::StrictTable timing = root.Table("timing");
  // Without a configuration the recording decides.
  session.period = config.empty() ? 0.0 : 1e-3 * timing.Number("period_ms", 100.0, 1.0, 10'000.0);
  // When a live run computes is not the matter of a replay.
  for (const char* key : {"deadline_ms", "adjust_budget_ms"}) timing.LeaveToOthers(key);
  for (const char* key : {"rt", "lcm", "gap_log"}) root.LeaveToOthers(key);
  root.Finish();
  if (seed) session.settings.sampler.seed = *seed;
  return session;
}

SourceRequest RequestFor(const Arguments& a, const Session& session, const Estimator& estimator) {
  SourceRequest request;
  request.data = a.data;
  request.plant = estimator.plant();
  request.num_inputs = estimator.num_inputs();
  request.described = session.settings.plant;
  if (!a.recording.empty()) {
    if (request.described == nullptr)
      throw support::InputError("--recording: the model is not a plant described by a file");
    auto recording = std::make_shared<support::Recording>(support::ReadRecording(a.recording, a.data_dir));
    if (recording->fingerprint != request.described->plant().fingerprint())
      throw support::InputError(a.recording + ": has other signals than the model, " +
                                request.described->plant().description().name);
    request.recording = std::move(recording);
  }
  request.period = session.period;
  request.overlap = session.settings.overlap;
  request.skip_bad = a.skip_bad;
  request.prefix = a.prefix;
  request.draws_from = a.draws_from;
  for (int mode = 0; mode < estimator.num_modes(); ++mode) request.mode_names.emplace_back(estimator.mode_name(mode));
  return request;
}

std::ofstream OpenOutput(const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  if (!file) throw support::InputError(path + ": cannot be written");
  return file;
}

void Close(std::ofstream* file, const std::string& path) {
  if (!file->flush()) throw std::runtime_error(path + ": writing failed");
}

}  // namespace armcmc::replay
