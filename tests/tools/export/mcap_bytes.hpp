#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace armcmc::log_export::mcap_bytes {

/// Reads fields of MCAP one after the other: little endian, texts and lists behind their length.
class Fields {
 public:
  explicit Fields(std::string_view bytes) : bytes_(bytes) {}

  template <typename Unsigned>
  Unsigned Take() {
    const std::string_view raw = Bytes(sizeof(Unsigned));
    Unsigned value = 0;
    for (std::size_t i = sizeof(Unsigned); i-- > 0;)
      value = static_cast<Unsigned>(value << 8U | static_cast<std::uint8_t>(raw[i]));
    return value;
  }
  std::string_view Bytes(std::size_t count) {
    if (count > bytes_.size()) throw std::runtime_error("MCAP: a field ends behind its record");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  std::string_view Sized() { return Bytes(Take<std::uint32_t>()); }
  [[nodiscard]] std::string_view rest() const { return bytes_; }
  [[nodiscard]] bool done() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

struct McapRecord {
  std::uint8_t op = 0;
  std::size_t at = 0;    ///< Of its opcode.
  std::size_t size = 0;  ///< With opcode and length.
  std::string_view content;
};

/// The records that fill bytes [from, until). @throws std::runtime_error when they do not.
inline std::vector<McapRecord> RecordsOf(std::string_view bytes, std::size_t from, std::size_t until) {
  std::vector<McapRecord> records;
  Fields fields(bytes.substr(from, until - from));
  while (!fields.done()) {
    McapRecord record;
    record.at = until - fields.rest().size();
    record.op = fields.Take<std::uint8_t>();
    record.content = fields.Bytes(fields.Take<std::uint64_t>());
    record.size = record.content.size() + 9;
    records.push_back(record);
  }
  return records;
}

inline constexpr std::size_t kMagicSize = 8;

/// Every record of a file.
inline std::vector<McapRecord> RecordsOf(std::string_view file) {
  if (file.size() < 2 * kMagicSize) throw std::runtime_error("MCAP: no file");
  return RecordsOf(file, kMagicSize, file.size() - kMagicSize);
}

struct McapMessageRead {
  std::string topic;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0, publish_time = 0;
  std::string data;
};

/// The messages in the chunks of a file, from front to end.
inline std::vector<McapMessageRead> MessagesOf(std::string_view file) {
  std::vector<std::string> topics;
  std::vector<McapMessageRead> messages;
  for (const McapRecord& record : RecordsOf(file)) {
    Fields fields(record.content);
    if (record.op == 0x0F) break;
    if (record.op == 0x04) {
      fields.Bytes(4);
      topics.emplace_back(fields.Sized());
    }
    if (record.op != 0x06) continue;
    fields.Bytes(8 + 8 + 8 + 4);
    fields.Sized();
    const std::string_view chunk = fields.Bytes(fields.Take<std::uint64_t>());
    for (const McapRecord& inner : RecordsOf(chunk, 0, chunk.size())) {
      Fields f(inner.content);
      McapMessageRead message;
      message.topic = topics.at(f.Take<std::uint16_t>());
      message.sequence = f.Take<std::uint32_t>();
      message.log_time = f.Take<std::uint64_t>();
      message.publish_time = f.Take<std::uint64_t>();
      message.data = f.rest();
      messages.push_back(message);
    }
  }
  return messages;
}

}  // namespace armcmc::log_export::mcap_bytes
