#include "armcmc/support/effect_library.hpp"

#include <algorithm>
#include <filesystem>

#include "armcmc/support/effect_file.hpp"
#include "armcmc/support/shared_files.hpp"
#include "nearest.hpp"

namespace armcmc::support {

std::vector<EffectEntry> ReadEffectLibrary() {
  std::vector<EffectEntry> entries;
  for (const std::string& name : SharedFileNames("effects")) {
    const std::filesystem::path path = SharedFolder("effects") / (name + ".toml");
    entries.push_back(ReadEffect(path));
    if (entries.back().name != name)
      throw ConfigError(path.string() + ": its name is \"" + entries.back().name + "\", expected that of the file");
  }
  if (entries.empty())
    throw ConfigError(SharedFolder("effects").string() +
                      ": no effects there: the catalogue is installed beside the programs, in share/armcmc/effects");
  return entries;
}

const EffectEntry& FindEffect(const std::vector<EffectEntry>& entries, const std::string& name,
                              const std::string& where) {
  std::vector<std::string> names;
  for (const EffectEntry& entry : entries) {
    if (entry.name == name) return entry;
    names.push_back(entry.name);
  }
  for (const EffectEntry& entry : entries)
    if (std::find(entry.aliases.begin(), entry.aliases.end(), name) != entry.aliases.end()) return entry;
  std::string known;
  for (const std::string& there : names) known += (known.empty() ? "" : ", ") + there;
  throw ConfigError(
      where + "no effect is called \"" + name + '"' + DidYouMean(name, names) +
      (known.empty() ? "; there are none in " + SharedFolder("effects").string() : "; available: " + known));
}

}  // namespace armcmc::support
