#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace armcmc::log_export {

/// CRC-32 of bytes (reflected polynomial 0xEDB88320, as of zlib and Ethernet), continued from that of the bytes before.
[[nodiscard]] std::uint32_t Crc32(std::string_view bytes, std::uint32_t before = 0) noexcept;

struct McapMessage {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;      ///< When it was recorded, in any order.
  std::uint64_t publish_time_ns = 0;  ///< When it was sent.
  std::string_view data;
};

/// Writes an MCAP file: schemas, channels and messages in chunks without compression, an index of the messages of each
/// chunk, and a summary with which a reader finds everything from the end of the file. All checksums are written.
///
/// A writer of our own, because Debian has no MCAP library; a test reads its files with the reference implementation.
/// Source: the MCAP format specification, https://mcap.dev/spec, format version 0.
class McapWriter {
 public:
  /// @param library      Name of the writing program: "armcmc-export 0.1.0".
  /// @param chunk_bytes  A chunk ends with the message that fills it.
  /// @throws support::InputError when the file cannot be written.
  McapWriter(std::filesystem::path path, std::string_view library, std::size_t chunk_bytes = 1U << 20U);

  /// @return its number, from 1 on.
  std::uint16_t AddSchema(std::string_view name, std::string_view encoding, std::string_view data);
  /// @param schema  Number of a schema that was added. @return its number, from 0 on.
  std::uint16_t AddChannel(std::uint16_t schema, std::string_view topic, std::string_view message_encoding);
  /// @pre The channel was added.
  void Write(const McapMessage& message);
  /// Writes what is missing of the file. Nothing may be added afterwards; without it the file is not complete.
  /// @throws std::runtime_error when the file could not be written.
  void Close();

 private:
  struct Times {
    std::uint64_t first = 0, last = 0;
    void Add(std::uint64_t time, bool is_first);
  };

  void Emit(std::string_view bytes);
  void EndChunk();

  std::filesystem::path path_;
  std::ofstream file_;
  std::size_t chunk_bytes_;
  std::uint64_t offset_ = 0;  ///< Bytes written.
  std::uint32_t crc_ = 0;     ///< Of them.

  std::string schemas_, channels_, chunk_indexes_;  ///< Records, as the summary repeats them.
  std::uint16_t num_schemas_ = 0, num_channels_ = 0;
  std::uint32_t num_chunks_ = 0;
  std::map<std::uint16_t, std::uint64_t> counts_;  ///< Messages by channel.
  std::uint64_t num_messages_ = 0;
  Times times_;  ///< Of all messages.

  std::string chunk_;                              ///< Records of the chunk that is being filled.
  std::map<std::uint16_t, std::string> in_chunk_;  ///< Its messages by channel: log_time and place.
  Times chunk_times_;
};

}  // namespace armcmc::log_export
