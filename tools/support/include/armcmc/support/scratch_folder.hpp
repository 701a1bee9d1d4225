#pragma once

#include <filesystem>
#include <string>

namespace armcmc::support {

/// A new folder among the temporary ones of the system, removed with all that is in it.
class ScratchFolder {
 public:
  /// @param purpose  Begins its name, before what makes it unique: "armcmc-bench".
  /// @throws std::runtime_error naming the folder that cannot be made.
  explicit ScratchFolder(const std::string& purpose);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Leaves the folder where it is.
  void Keep() { kept_ = true; }

 private:
  std::filesystem::path path_;
  bool kept_ = false;
};

}  // namespace armcmc::support
