#include "armcmc/bench/suite.hpp"

#include <algorithm>

#include "armcmc/bench/press.hpp"
#include "armcmc/sample_size.hpp"
#include "armcmc/settings.hpp"
#include "armcmc/types.hpp"
#include "steps.hpp"

namespace armcmc::bench {

Suite MakeSuite(const std::vector<std::string>& models) {
  Suite suite;
  suite.draws = {0, 500, 2000, 5000, 50'000};
  suite.samples = {20, 50, 100, 200, kMaxPackSamples};
  for (const std::string& model : models) {
    const std::vector<Plant> known = KnownPlants();
    const auto it = std::find_if(known.begin(), known.end(), [&](const Plant& plant) { return plant.name == model; });
    suite.plants.push_back(it != known.end() ? *it : Plant{model, model});
    (void)SettingsOf(suite.plants.back());
  }
  if (models.empty()) suite.plants = KnownPlants();
  return suite;
}

void Register(const Suite& suite, const std::filesystem::path& folder) {
  constexpr int kSamples = 100;
  for (const Plant& plant : suite.plants) {
    RegisterSteps(plant, 0, kSamples, folder);
    RegisterMemory(plant);
    RegisterScore(plant, folder);
    if (plant.name != PressedPlant()) continue;
    // How the step grows: of one plant, as the law of another costs more for a sample and no less for a draw.
    for (const int draws : suite.draws)
      if (draws > 0) RegisterSteps(plant, draws, kSamples, folder);
    for (const int samples : suite.samples)
      if (samples != kSamples) RegisterSteps(plant, 0, samples, folder);
    RegisterDimensions();
    RegisterEverySample(plant, kSamples, folder);
    RegisterNoise(plant, folder);
    RegisterEffects(plant, folder);
    RegisterNaiveLoop(ChernoffDraws(SamplerSettings().epsilon, SamplerSettings().delta), kSamples);
    if (suite.quality) RegisterQuality();
  }
}

}  // namespace armcmc::bench
