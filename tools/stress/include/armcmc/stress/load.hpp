#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/stress/child.hpp"

namespace armcmc::stress {

/// Names of the loads there are.
[[nodiscard]] const std::vector<std::string>& LoadNames();
/// @throws std::invalid_argument naming one that does not exist.
[[nodiscard]] std::vector<std::string> SelectLoads(const std::string& list);

/// Makes one load in processes beside the pair: generators of this program's own, and stress-ng when it is there.
class Load {
 public:
  /// @param folder  For what the disk load and the logger write; bounded.
  Load(const std::string& name, const std::string& lcm_url, const std::filesystem::path& folder);
  /// What runs, and what could not: "lcm-spy skipped: no display".
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  /// Keeps the files of the children short.
  void TrimFiles() const;

 private:
  void Start(const std::vector<std::string>& command, const std::string& note);

  std::filesystem::path folder_;
  std::vector<std::unique_ptr<Child>> children_;
  std::vector<std::string> notes_;
};

/// The body of a generator process: loads the machine until it is killed. @param name  cpu, memory, io, net or flood.
/// @return the exit code when it cannot do so.
[[nodiscard]] int GenerateLoad(const std::string& name, const std::string& lcm_url,
                               const std::filesystem::path& folder);

}  // namespace armcmc::stress
