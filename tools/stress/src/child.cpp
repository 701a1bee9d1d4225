#include "armcmc/stress/child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>
#include <utility>

namespace armcmc::stress {

Child::Child(const std::vector<std::string>& command, std::filesystem::path log) : log_(std::move(log)) {
  std::vector<std::string> texts = command;
  std::vector<char*> argv;
  for (std::string& text : texts) argv.push_back(text.data());
  argv.push_back(nullptr);
  const int file = open(log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0600);
  if (file < 0) throw std::runtime_error(log_.string() + ": " + std::strerror(errno));
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);
    dup2(open("/dev/null", O_RDONLY | O_CLOEXEC), STDIN_FILENO);
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  close(file);
  if (pid_ < 0) throw std::runtime_error("cannot start " + command.front() + ": " + std::strerror(errno));
}

Child::~Child() {
  if (exit_code_ >= 0) return;
  kill(pid_, SIGCONT);
  kill(pid_, SIGKILL);
  Reap(0);
}

void Child::Signal(int signal) const {
  if (exit_code_ < 0) kill(pid_, signal);
}

bool Child::Reap(int options) {
  if (exit_code_ >= 0) return true;
  int status = 0;
  if (waitpid(pid_, &status, options) != pid_) return false;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return true;
}

bool Child::running() { return !Reap(WNOHANG); }

void Child::Wait(int timeout_ms) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(timeout_ms);
  while (!Reap(WNOHANG)) {
    if (std::chrono::steady_clock::now() > end) {
      kill(pid_, SIGKILL);
      Reap(0);
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

long Child::rss_kb() const {
  std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stol(line.substr(6));
  }
  return 0;
}

std::string Child::output() const {
  std::ifstream file(log_, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void Child::TrimLog() const {
  std::error_code error;
  const auto size = std::filesystem::file_size(log_, error);
  if (!error && size > (1U << 20U)) std::filesystem::resize_file(log_, 0, error);
}

}  // namespace armcmc::stress
