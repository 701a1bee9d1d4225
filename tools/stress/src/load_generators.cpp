#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstring>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "armcmc/rt/clock.hpp"
#include "armcmc/stress/load.hpp"

namespace armcmc::stress {
namespace {

volatile double g_sink = 0.0;

[[noreturn]] void BurnProcessor() {
  double value = 1.0;
  for (;;) {
    for (int i = 0; i < 1'000'000; ++i) value = std::sqrt(value + i);
    g_sink = value;
  }
}

/// Memory bandwidth by copies larger than the caches, and page faults by memory that is given back every time.
[[noreturn]] void BurnMemory() {
  constexpr std::size_t kBytes = 64U << 20U;
  std::vector<char> from(kBytes, 1), to(kBytes, 2);
  for (;;) {
    for (int i = 0; i < 4; ++i) {
      std::memcpy(to.data(), from.data(), kBytes);
      std::memcpy(from.data(), to.data(), kBytes);
    }
    void* pages = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (pages == MAP_FAILED) continue;
    std::memset(pages, 3, kBytes);
    munmap(pages, kBytes);
  }
}

/// One file of 32 MB, written and flushed again and again.
int BurnDisk(const std::filesystem::path& folder) {
  const std::string path = folder / ("disk-load." + std::to_string(getpid()));
  const std::vector<char> block(1U << 20U, 7);
  for (;;) {
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0) return 1;
    unlink(path.c_str());
    for (int i = 0; i < 32; ++i) {
      if (write(file, block.data(), block.size()) < 0) return 1;
      if (i % 8 == 7) fsync(file);
    }
    close(file);
  }
}

/// Other channels on the same port. `names` different ones, so that every program on the bus has to look.
int Flood(const std::string& url, int per_second, std::size_t bytes, int names) {
  lcm::LCM bus(url);
  if (!bus.good()) return 1;
  const std::vector<char> payload(bytes, 9);
  constexpr Nanos kTick = rt::kNanosPerMilli;
  const int per_tick = std::max(1, per_second / 1000);
  Nanos next_ns = rt::MonotonicNow();
  for (int name = 0;;) {
    for (int i = 0; i < per_tick; ++i) {
      name = (name + 1) % names;
      bus.publish("NOISE_" + std::to_string(name), payload.data(), static_cast<unsigned>(payload.size()));
    }
    // After a stall it goes on at its rate: it does not catch up.
    next_ns = std::max(next_ns + kTick, rt::MonotonicNow());
    rt::SleepUntil(next_ns);
  }
}

}  // namespace

int GenerateLoad(const std::string& name, const std::string& lcm_url, const std::filesystem::path& folder) {
  if (name == "cpu") BurnProcessor();
  if (name == "memory") BurnMemory();
  if (name == "io") return BurnDisk(folder);
  if (name == "net") return Flood(lcm_url, 2000, 4000, 4);
  if (name == "flood") return Flood(lcm_url, 40'000, 64, 500);
  return 2;
}

}  // namespace armcmc::stress
