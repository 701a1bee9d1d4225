#include "armcmc/log_export/mcap_writer.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <utility>

#include "armcmc/support/program.hpp"

namespace armcmc::log_export {
namespace {

constexpr std::string_view kMagic = "\x89MCAP0\r\n";

enum class Op : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

constexpr std::array<std::uint32_t, 256> MakeCrcTable() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::uint32_t rest = byte;
    for (int bit = 0; bit < 8; ++bit) rest = (rest >> 1U) ^ ((rest & 1U) != 0 ? 0xEDB88320U : 0U);
    table[byte] = rest;
  }
  return table;
}
constexpr std::array<std::uint32_t, 256> kCrcTable = MakeCrcTable();

template <typename Unsigned>
void Put(Unsigned value, std::string* bytes) {
  for (std::size_t i = 0; i < sizeof value; ++i)
    bytes->push_back(static_cast<char>(value >> (8 * i)));  // little endian
}

/// A text, or an array or map whose entries are already bytes: each follows its length.
void PutSized(std::string_view data, std::string* bytes) {
  if (data.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::runtime_error("MCAP: more than 4 GiB in one field");
  Put(static_cast<std::uint32_t>(data.size()), bytes);
  bytes->append(data);
}

std::string Record(Op op, std::string_view content) {
  std::string record;
  record.reserve(content.size() + 9);
  Put(static_cast<std::uint8_t>(op), &record);
  Put(static_cast<std::uint64_t>(content.size()), &record);
  return record.append(content);
}

std::uint16_t Next(std::uint16_t* count, const char* what) {
  if (*count == std::numeric_limits<std::uint16_t>::max())
    throw std::runtime_error(std::string("MCAP: more than 65534 ") + what);
  return (*count)++;
}

}  // namespace

std::uint32_t Crc32(std::string_view bytes, std::uint32_t before) noexcept {
  std::uint32_t rest = ~before;
  for (const char c : bytes) rest = (rest >> 8U) ^ kCrcTable[(rest ^ static_cast<std::uint8_t>(c)) & 0xFFU];
  return ~rest;
}

void McapWriter::Times::Add(std::uint64_t time, bool is_first) {
  first = is_first ? time : std::min(first, time);
  last = is_first ? time : std::max(last, time);
}

McapWriter::McapWriter(std::filesystem::path path, std::string_view library, std::size_t chunk_bytes)
    : path_(std::move(path)), file_(path_, std::ios::binary), chunk_bytes_(chunk_bytes) {
  if (!file_) throw support::InputError(path_.string() + ": cannot be written");
  Emit(kMagic);
  std::string header;
  PutSized("", &header);  // no profile: the messages follow the rules of no framework
  PutSized(library, &header);
  Emit(Record(Op::kHeader, header));
}

void McapWriter::Emit(std::string_view bytes) {
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  offset_ += bytes.size();
  crc_ = Crc32(bytes, crc_);
}

std::uint16_t McapWriter::AddSchema(std::string_view name, std::string_view encoding, std::string_view data) {
  const auto id = static_cast<std::uint16_t>(Next(&num_schemas_, "schemas") + 1);  // 0 means: without a schema
  std::string content;
  Put(id, &content);
  PutSized(name, &content);
  PutSized(encoding, &content);
  PutSized(data, &content);
  const std::string record = Record(Op::kSchema, content);
  Emit(record);
  schemas_ += record;
  return id;
}

std::uint16_t McapWriter::AddChannel(std::uint16_t schema, std::string_view topic, std::string_view message_encoding) {
  const std::uint16_t id = Next(&num_channels_, "channels");
  std::string content;
  Put(id, &content);
  Put(schema, &content);
  PutSized(topic, &content);
  PutSized(message_encoding, &content);
  PutSized("", &content);  // no metadata
  const std::string record = Record(Op::kChannel, content);
  Emit(record);
  channels_ += record;
  counts_[id] = 0;
  return id;
}

void McapWriter::Write(const McapMessage& message) {
  std::string& index = in_chunk_[message.channel];
  Put(message.log_time_ns, &index);
  Put(static_cast<std::uint64_t>(chunk_.size()), &index);
  chunk_times_.Add(message.log_time_ns, chunk_.empty());
  times_.Add(message.log_time_ns, num_messages_ == 0);
  ++num_messages_;
  ++counts_[message.channel];
  std::string content;
  content.reserve(message.data.size() + 22);
  Put(message.channel, &content);
  Put(message.sequence, &content);
  Put(message.log_time_ns, &content);
  Put(message.publish_time_ns, &content);
  content.append(message.data);
  chunk_ += Record(Op::kMessage, content);
  if (chunk_.size() >= chunk_bytes_) EndChunk();
}

void McapWriter::EndChunk() {
  if (chunk_.empty()) return;
  const auto size = static_cast<std::uint64_t>(chunk_.size());
  std::string content;
  Put(chunk_times_.first, &content);
  Put(chunk_times_.last, &content);
  Put(size, &content);
  Put(Crc32(chunk_), &content);
  PutSized("", &content);  // not compressed
  Put(size, &content);
  content += chunk_;
  const std::uint64_t chunk_start = offset_;
  Emit(Record(Op::kChunk, content));

  const std::uint64_t indexes_start = offset_;
  std::string places;
  for (const auto& [channel, entries] : in_chunk_) {
    Put(channel, &places);
    Put(offset_, &places);
    std::string index;
    Put(channel, &index);
    PutSized(entries, &index);
    Emit(Record(Op::kMessageIndex, index));
  }

  content.clear();
  Put(chunk_times_.first, &content);
  Put(chunk_times_.last, &content);
  Put(chunk_start, &content);
  Put(indexes_start - chunk_start, &content);
  PutSized(places, &content);
  Put(offset_ - indexes_start, &content);
  PutSized("", &content);
  Put(size, &content);
  Put(size, &content);
  chunk_indexes_ += Record(Op::kChunkIndex, content);
  ++num_chunks_;
  chunk_.clear();
  in_chunk_.clear();
}

void McapWriter::Close() {
  EndChunk();
  std::string content;
  Put(crc_, &content);
  Emit(Record(Op::kDataEnd, content));

  // The checksum of the summary begins anew with it.
  const std::uint64_t summary_start = offset_;
  crc_ = 0;
  std::string offsets;
  const auto emit_group = [&](Op op, const std::string& records) {
    if (records.empty()) return;
    std::string group;
    Put(static_cast<std::uint8_t>(op), &group);
    Put(offset_, &group);
    Put(static_cast<std::uint64_t>(records.size()), &group);
    offsets += Record(Op::kSummaryOffset, group);
    Emit(records);
  };
  emit_group(Op::kSchema, schemas_);
  emit_group(Op::kChannel, channels_);
  content.clear();
  Put(num_messages_, &content);
  Put(num_schemas_, &content);
  Put(static_cast<std::uint32_t>(num_channels_), &content);
  Put(std::uint32_t{0}, &content);  // attachments
  Put(std::uint32_t{0}, &content);  // metadata records
  Put(num_chunks_, &content);
  Put(times_.first, &content);
  Put(times_.last, &content);
  std::string counts;
  for (const auto& [channel, count] : counts_) {
    Put(channel, &counts);
    Put(count, &counts);
  }
  PutSized(counts, &content);
  emit_group(Op::kStatistics, Record(Op::kStatistics, content));
  emit_group(Op::kChunkIndex, chunk_indexes_);

  const std::uint64_t offsets_start = offset_;
  Emit(offsets);
  content.clear();
  Put(summary_start, &content);
  Put(offsets_start, &content);
  std::string footer = Record(Op::kFooter, content);
  // Its length counts the checksum, which covers everything before itself.
  footer[1] = static_cast<char>(content.size() + sizeof crc_);
  Put(Crc32(footer, crc_), &footer);
  Emit(footer);
  Emit(kMagic);
  if (!file_.flush()) throw std::runtime_error(path_.string() + ": writing failed");
  file_.close();
}

}  // namespace armcmc::log_export
