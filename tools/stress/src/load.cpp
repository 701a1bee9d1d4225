#include "armcmc/stress/load.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace armcmc::stress {
namespace {

const std::vector<std::string> kNames = {"none", "cpu", "memory", "io", "net", "watchers"};

bool OnPath(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((folder + "/" + program).c_str(), X_OK) == 0) return true;
  return false;
}

std::vector<std::string> StressNg(const std::string& name, const std::filesystem::path& folder) {
  std::vector<std::string> command = {"stress-ng", "--quiet", "--temp-path", folder.string()};
  if (name == "cpu") command.insert(command.end(), {"--matrix", "1"});
  if (name == "memory") command.insert(command.end(), {"--vm", "1", "--vm-bytes", "128M"});
  if (name == "io") command.insert(command.end(), {"--hdd", "1", "--hdd-bytes", "32M"});
  return command;
}

}  // namespace

const std::vector<std::string>& LoadNames() { return kNames; }

std::vector<std::string> SelectLoads(const std::string& list) {
  std::vector<std::string> chosen;
  std::istringstream items(list);
  for (std::string item; std::getline(items, item, ',');) {
    if (std::find(kNames.begin(), kNames.end(), item) == kNames.end()) {
      throw std::invalid_argument("--load " + item + ": no such load; there are none, cpu, memory, io, net, watchers");
    }
    chosen.push_back(item);
  }
  if (chosen.empty()) throw std::invalid_argument("--load: expected a list, for example none,cpu,memory,io,net");
  return chosen;
}

Load::Load(const std::string& name, const std::string& lcm_url, const std::filesystem::path& folder) : folder_(folder) {
  if (name == "none") return;
  if (name == "watchers") {
    if (OnPath("lcm-logger")) {
      Start({"lcm-logger", "--lcm-url=" + lcm_url, "--rotate=2", "--split-mb=20", (folder_ / "watched.lcm").string()},
            "lcm-logger");
    } else {
      notes_.emplace_back("lcm-logger skipped: not installed (liblcm-bin)");
    }
    if (std::getenv("DISPLAY") == nullptr) {
      notes_.emplace_back("lcm-spy skipped: no display");
    } else if (!OnPath("lcm-spy")) {
      notes_.emplace_back("lcm-spy skipped: not installed (liblcm-bin)");
    } else {
      Start({"lcm-spy", "--lcm-url=" + lcm_url}, "lcm-spy");
    }
    return;
  }
  // One a processor for what a single thread cannot saturate.
  const long processors = name == "cpu" || name == "memory" ? std::max(1L, sysconf(_SC_NPROCESSORS_ONLN)) : 1;
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  for (long i = 0; i < processors; ++i) {
    Start({self, "--generate", name, "--lcm-url", lcm_url, "--work", folder_.string()}, i == 0 ? name : "");
  }
  if (name == "net") return;
  if (OnPath("stress-ng")) {
    Start(StressNg(name, folder_), "stress-ng");
  } else {
    notes_.emplace_back("stress-ng skipped: not installed");
  }
}

void Load::Start(const std::vector<std::string>& command, const std::string& note) {
  children_.push_back(std::make_unique<Child>(command, folder_ / ("load" + std::to_string(children_.size()) + ".log")));
  if (!note.empty()) notes_.push_back(note);
}

void Load::TrimFiles() const {
  for (const auto& child : children_) child->TrimLog();
}

}  // namespace armcmc::stress
