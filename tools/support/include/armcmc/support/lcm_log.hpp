#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace armcmc::support {

/// One event of an LCM log. Channel and data point into the log and live as long as its reader.
struct LcmLogEvent {
  std::int64_t number = 0;  ///< Counts from 0 in a whole log.
  std::int64_t utime = 0;   ///< us, CLOCK_REALTIME of the logger.
  std::string_view channel;
  std::span<const std::uint8_t> data;
};

/// What a log has lost.
struct LcmLogDamage {
  std::size_t resyncs = 0;  ///< Places where bytes had to be skipped to find the next event.
  std::size_t skipped_bytes = 0;
  std::int64_t missing_events = 0;  ///< By the numbers of the events around the gaps.
  std::int64_t wrong_numbers = 0;   ///< Events whose number does not fit their place; they are read all the same.
  bool cut_off = false;             ///< The last event is incomplete, as after a kill or a full disk.
  [[nodiscard]] bool any() const { return resyncs > 0 || missing_events > 0 || wrong_numbers > 0 || cut_off; }
};

/// The damage in words: "2 places skipped (1310 bytes), 2 events missing, cut off at its end"; empty without damage.
[[nodiscard]] std::string ToString(const LcmLogDamage& damage);

/// Reads the events of an LCM log in file order, over damaged places.
///
/// The format is that of lcm-logger: sync word 0xEDA1DA01, number, utime, lengths, channel, data, big endian.
/// An event whose length leads to no following event, while one starts inside it, has a damaged length: it is
/// dropped and the events that it would have swallowed are read. A damaged number is replaced by the one that its place
/// in the file gives it. (The library's own reader stops at a damaged
/// header as if the file ended there, and loses what a damaged length spans.) A damaged payload cannot be
/// seen here: the format has no checksum.
class LcmLogReader {
 public:
  /// @throws InputError when the file cannot be read, or holds no event at all.
  explicit LcmLogReader(const std::filesystem::path& path);
  ~LcmLogReader();
  LcmLogReader(const LcmLogReader&) = delete;
  LcmLogReader& operator=(const LcmLogReader&) = delete;

  /// The next event. @return false at the end.
  bool Next(LcmLogEvent* event);
  /// Complete once Next() has returned false.
  [[nodiscard]] const LcmLogDamage& damage() const { return damage_; }
  /// Share of the file that has been read, in [0, 1].
  [[nodiscard]] double progress() const;

 private:
  [[nodiscard]] bool Parse(std::size_t at, LcmLogEvent* event, std::size_t* end) const;
  [[nodiscard]] bool HeaderIsCut(std::size_t at) const;
  [[nodiscard]] std::size_t FindSync(std::size_t from, std::size_t to) const;
  [[nodiscard]] bool NumberFits(const LcmLogEvent& event, std::size_t end) const;
  void Count(LcmLogEvent* event, std::size_t end);
  [[nodiscard]] bool EventStartsWithin(std::size_t from, std::size_t to, std::int64_t after_number) const;

  std::span<const std::uint8_t> bytes_;  // the mapped file
  std::size_t at_ = 0;
  std::int64_t next_number_ = 0;
  LcmLogDamage damage_;
};

}  // namespace armcmc::support
