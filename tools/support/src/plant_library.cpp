#include "armcmc/support/plant_library.hpp"

#include <algorithm>
#include <system_error>

#include "armcmc/support/shared_files.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "nearest.hpp"

namespace armcmc::support {
namespace fs = std::filesystem;

namespace {

constexpr const char* kFile = "plant.toml";

}  // namespace

fs::path FindPlantFile(const std::string& model) {
  std::error_code error;
  if (fs::is_regular_file(model, error)) return model;
  const fs::path shared = SharedFolder("plants");
  // A path is not looked for among names: "../my_axis" is none.
  const bool is_name = model.find('/') == std::string::npos;
  if (is_name && fs::is_regular_file(shared / model / kFile, error)) return shared / model / kFile;
  std::string known;
  const std::vector<std::string> names = PlantNames();
  for (const std::string& there : names) known += (known.empty() ? "" : ", ") + there;
  throw ConfigError(model + ": no such plant file, and no plant of that name in " + shared.string() +
                    DidYouMean(model, names) + (known.empty() ? "" : "; available: " + known));
}

std::vector<std::string> PlantNames() {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(SharedFolder("plants"), error))
    if (fs::is_regular_file(entry.path() / kFile, error)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace armcmc::support
