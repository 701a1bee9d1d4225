#include "integration/pty_process.hpp"

#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>
#include <utmp.h>

#include <stdexcept>

namespace armcmc::test {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

PtyProcess::PtyProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments, int columns,
                       int rows) {
  winsize size{};
  size.ws_col = static_cast<unsigned short>(columns);
  size.ws_row = static_cast<unsigned short>(rows);
  if (openpty(&master_, &slave_, nullptr, nullptr, &size) != 0) throw std::runtime_error("no pseudo terminal");
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), program.string());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("fork failed");
  if (pid_ == 0) {
    close(master_);
    login_tty(dup(slave_));
    setenv("LC_ALL", "C.UTF-8", 1);
    unsetenv("NO_COLOR");
    execv(argv[0], argv.data());
    _exit(127);
  }
}

PtyProcess::~PtyProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  close(master_);
  close(slave_);
}

void PtyProcess::Type(const std::string& keys) const {
  if (write(master_, keys.data(), keys.size()) < 0) throw std::runtime_error("cannot type");
}

void PtyProcess::Resize(int columns, int rows) const {
  winsize size{};
  size.ws_col = static_cast<unsigned short>(columns);
  size.ws_row = static_cast<unsigned short>(rows);
  ioctl(master_, TIOCSWINSZ, &size);  // the kernel tells the program
}

void PtyProcess::Signal(int signal) const { kill(pid_, signal); }

bool PtyProcess::ReadFor(std::chrono::milliseconds time) {
  pollfd readable{master_, POLLIN, 0};
  if (poll(&readable, 1, static_cast<int>(time.count())) <= 0) return true;
  char buffer[4096];
  const ssize_t n = read(master_, buffer, sizeof buffer);
  if (n <= 0) return false;
  output_.append(buffer, static_cast<std::size_t>(n));
  return true;
}

bool PtyProcess::WaitFor(const std::string& text) {
  const auto end = Clock::now() + std::chrono::seconds(20);
  do {
    const std::size_t at = output_.find(text, searched_);
    if (at != std::string::npos) {
      searched_ = at + text.size();
      return true;
    }
  } while (ReadFor(std::chrono::milliseconds(50)) && Clock::now() < end);
  return false;
}

int PtyProcess::Wait() {
  const auto end = Clock::now() + std::chrono::seconds(10);
  int status = 0;
  while (Clock::now() < end) {
    ReadFor(std::chrono::milliseconds(20));
    if (waitpid(pid_, &status, WNOHANG) != pid_) continue;
    pid_ = -1;
    ReadFor(std::chrono::milliseconds(50));
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  return -1;
}

bool PtyProcess::TerminalIsAsBefore() const {
  termios now{};
  return tcgetattr(slave_, &now) == 0 && (now.c_lflag & ICANON) != 0 && (now.c_lflag & ECHO) != 0;
}

}  // namespace armcmc::test
