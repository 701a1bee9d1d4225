#include "armcmc/stress/stressed_plant.hpp"

#include <algorithm>
#include <string_view>

#include "armcmc/models/registry.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::embedded {
std::string_view StressedPlant() noexcept;
}  // namespace armcmc::embedded

namespace armcmc::stress {
namespace {

StressedPlant Read() {
  support::StrictTable table = support::StrictTable::FromText(embedded::StressedPlant(), "plant.toml");
  table.RequireSchema();
  StressedPlant plant{0, table.RequiredText("name"), table.RequiredText("scenario"),
                      table.RequiredNumber("noise_std", 0.0, 1e9)};
  table.Finish();
  const auto models = CompiledModels();
  const auto found =
      std::find_if(models.begin(), models.end(), [&](const ModelInfo* model) { return model->name == plant.name; });
  if (found == models.end()) throw table.Error("name", "expected a plant that is compiled in");
  plant.number = static_cast<std::int32_t>((*found)->plant);
  return plant;
}

}  // namespace

const StressedPlant& PlantUnderStress() {
  static const StressedPlant plant = Read();
  return plant;
}

}  // namespace armcmc::stress
