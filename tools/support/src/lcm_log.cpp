#include "armcmc/support/lcm_log.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "armcmc/support/program.hpp"

namespace armcmc::support {
namespace {

constexpr std::array<std::uint8_t, 4> kSync = {0xED, 0xA1, 0xDA, 0x01};
constexpr std::size_t kHeaderSize = 28;
constexpr std::int64_t kMaxChannelLength = 63;  // of LCM itself
constexpr std::int64_t kMaxJump = 1000;         // events that may be missing at one place

std::int64_t BigEndian(const std::uint8_t* bytes, int count) {
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[i];
  return static_cast<std::int64_t>(value);
}

std::string Counted(std::int64_t n, const char* what) { return std::to_string(n) + " " + what + (n == 1 ? "" : "s"); }

}  // namespace

std::string ToString(const LcmLogDamage& damage) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  const auto bytes = static_cast<std::int64_t>(damage.skipped_bytes);
  if (damage.resyncs > 0)
    add(Counted(static_cast<std::int64_t>(damage.resyncs), "place") + " skipped (" + Counted(bytes, "byte") + ")");
  if (damage.missing_events > 0) add(Counted(damage.missing_events, "event") + " missing");
  if (damage.wrong_numbers > 0) add(Counted(damage.wrong_numbers, "event") + " with a wrong number");
  if (damage.cut_off) add("cut off at its end" + (damage.resyncs == 0 ? " (" + Counted(bytes, "byte") + ")" : ""));
  return text;
}

LcmLogReader::LcmLogReader(const std::filesystem::path& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat info {};
  if (fd < 0 || fstat(fd, &info) != 0 || !S_ISREG(info.st_mode)) {
    const std::string why = fd < 0 ? std::strerror(errno) : "not a file";
    if (fd >= 0) close(fd);
    throw InputError(path.string() + ": cannot be read (" + why + "), expected an LCM log");
  }
  const auto size = static_cast<std::size_t>(info.st_size);
  void* const map = size == 0 ? MAP_FAILED : mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
  close(fd);
  if (map == MAP_FAILED)
    throw InputError(path.string() + (size == 0 ? ": is empty" : ": cannot be mapped") + ", expected an LCM log");
  bytes_ = {static_cast<const std::uint8_t*>(map), size};
  if (FindSync(0, size) == size) {
    munmap(map, size);
    throw InputError(path.string() + ": contains no event of an LCM log");
  }
}

LcmLogReader::~LcmLogReader() { munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size()); }

double LcmLogReader::progress() const { return static_cast<double>(at_) / static_cast<double>(bytes_.size()); }

std::size_t LcmLogReader::FindSync(std::size_t from, std::size_t to) const {
  const auto begin = bytes_.begin(), end = begin + static_cast<std::ptrdiff_t>(to);
  const auto found =
      std::search(begin + static_cast<std::ptrdiff_t>(std::min(from, to)), end, kSync.begin(), kSync.end());
  return static_cast<std::size_t>(found - begin);
}

// True when a plausible header stands at `at`; then the event, whose data may reach past the end of the file.
bool LcmLogReader::Parse(std::size_t at, LcmLogEvent* event, std::size_t* end) const {
  if (at + kHeaderSize > bytes_.size() || !std::equal(kSync.begin(), kSync.end(), bytes_.data() + at)) return false;
  const std::uint8_t* header = bytes_.data() + at;
  const std::int64_t channel_length = BigEndian(header + 20, 4), data_length = BigEndian(header + 24, 4);
  if (channel_length < 1 || channel_length > kMaxChannelLength || data_length > INT32_MAX) return false;
  const auto channel_size = static_cast<std::size_t>(channel_length), data_size = static_cast<std::size_t>(data_length);
  *end = at + kHeaderSize + channel_size + data_size;
  event->number = BigEndian(header + 4, 8);
  event->utime = BigEndian(header + 12, 8);
  if (event->number < 0) return false;
  if (*end > bytes_.size()) return true;
  // The bytes of a channel name are characters.
  event->channel = {reinterpret_cast<const char*>(header + kHeaderSize), channel_size};
  if (!std::all_of(event->channel.begin(), event->channel.end(), [](char c) { return c > ' ' && c < '\x7f'; }))
    return false;
  event->data = {header + kHeaderSize + channel_size, data_size};
  return true;
}

// True when the file ends within a header.
bool LcmLogReader::HeaderIsCut(std::size_t at) const {
  const std::size_t left = bytes_.size() - at;
  return left < kHeaderSize &&
         std::equal(bytes_.begin() + static_cast<std::ptrdiff_t>(at),
                    bytes_.begin() + static_cast<std::ptrdiff_t>(at + std::min(left, kSync.size())), kSync.begin());
}

bool LcmLogReader::EventStartsWithin(std::size_t from, std::size_t to, std::int64_t after_number) const {
  for (std::size_t at = FindSync(from, to); at < to; at = FindSync(at + 1, to)) {
    LcmLogEvent inner;
    std::size_t end = 0;
    // Its number goes on from here: the sync word may also be part of somebody's data.
    if (Parse(at, &inner, &end) && inner.number > after_number && inner.number <= after_number + kMaxJump) return true;
  }
  return false;
}

// A number is believed when it follows, or when the next event agrees with it; a small jump also without that.
bool LcmLogReader::NumberFits(const LcmLogEvent& event, std::size_t end) const {
  if (event.number == next_number_) return true;
  LcmLogEvent next;
  std::size_t next_end = 0;
  if (end < bytes_.size() && Parse(end, &next, &next_end)) {
    if (next.number == next_number_ + 1) return false;
    if (next.number == event.number + 1) return true;
  }
  return event.number > next_number_ && event.number <= next_number_ + kMaxJump;
}

void LcmLogReader::Count(LcmLogEvent* event, std::size_t end) {
  if (!NumberFits(*event, end)) {
    ++damage_.wrong_numbers;
    event->number = next_number_;
  }
  damage_.missing_events += std::max<std::int64_t>(event->number - next_number_, 0);
  next_number_ = event->number + 1;
}

bool LcmLogReader::Next(LcmLogEvent* event) {
  const std::size_t start = at_;
  bool skipped = false;
  while (at_ < bytes_.size()) {
    if (HeaderIsCut(at_)) {
      damage_.cut_off = true;
      break;
    }
    std::size_t end = 0;
    bool good = Parse(at_, event, &end);
    if (good && end != bytes_.size()) {
      const bool followed =
          end + kSync.size() <= bytes_.size() && std::equal(kSync.begin(), kSync.end(), bytes_.data() + end);
      if (!followed) good = end < bytes_.size() && !EventStartsWithin(at_ + kHeaderSize, end, event->number);
      if (end > bytes_.size() && !EventStartsWithin(at_ + kHeaderSize, bytes_.size(), event->number)) {
        damage_.cut_off = true;
        break;
      }
    }
    if (good) {
      Count(event, end);
      damage_.skipped_bytes += at_ - start;
      at_ = end;
      return true;
    }
    if (!skipped) ++damage_.resyncs;
    skipped = true;
    at_ = FindSync(at_ + 1, bytes_.size());
  }
  damage_.skipped_bytes += bytes_.size() - start;
  at_ = bytes_.size();
  return false;
}

}  // namespace armcmc::support
