#include "armcmc/support/scratch_folder.hpp"

#include <stdlib.h>

#include <stdexcept>
#include <system_error>

namespace armcmc::support {

ScratchFolder::ScratchFolder(const std::string& purpose) {
  std::string name = (std::filesystem::temp_directory_path() / purpose).string() + "-XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": no such folder can be made");
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  if (kept_) return;
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace armcmc::support
