#pragma once

#include <filesystem>
#include <fstream>

#include "armcmc/compare/trace.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "tools/replay_data.hpp"

namespace armcmc::compare {

inline EstimatorSettings FastSettings() {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = 800;
  return settings;
}

/// One run over 20 packs of the deterministic contact; writes its recording into `csv`.
inline RunTrace TraceOf(const EstimatorSettings& settings, const std::filesystem::path& csv, const char* label) {
  std::ofstream(csv) << replay::ContactCsv(2001);
  replay::SourceRequest request = replay::ContactRequest();
  request.data = csv;
  const auto source = replay::OpenSource(request);
  return TraceRun(settings, source.get(), label, [](double) {});
}

inline EffectSettings Friction() { return MakeEffect(HuntCrossley::kInfo, "coulomb_friction"); }

}  // namespace armcmc::compare
