#include "armcmc/support/shared_files.hpp"

#include <algorithm>
#include <system_error>

#include "armcmc/support/strict_toml.hpp"
#include "nearest.hpp"

namespace armcmc::support {
namespace fs = std::filesystem;

namespace {

fs::path& GivenPrefix() {
  static fs::path prefix;
  return prefix;
}

}  // namespace

void UseSharedPrefix(const fs::path& prefix) { GivenPrefix() = prefix; }

fs::path SharedFolder(const std::string& kind) {
  if (!GivenPrefix().empty()) return GivenPrefix() / "share" / "armcmc" / kind;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return program.parent_path().parent_path() / "share" / "armcmc" / kind;
}

fs::path FindSharedFile(const std::string& kind, const std::string& name) {
  std::error_code error;
  const fs::path shared = SharedFolder(kind);
  for (const fs::path& candidate : {fs::path(name), fs::path(name + ".toml"), shared / name, shared / (name + ".toml")})
    if (fs::is_regular_file(candidate, error)) return candidate;
  std::string known;
  const std::vector<std::string> names = SharedFileNames(kind);
  for (const std::string& there : names) known += (known.empty() ? "" : ", ") + there;
  throw ConfigError(name + ": no such file, neither here nor in " + shared.string() + DidYouMean(name, names) +
                    (known.empty() ? "" : "; available: " + known));
}

std::vector<std::string> SharedFileNames(const std::string& kind) {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(SharedFolder(kind), error))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace armcmc::support
