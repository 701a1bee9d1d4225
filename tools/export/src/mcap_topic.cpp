#include "mcap_topic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "armcmc/log_export/columns.hpp"
#include "number_text.hpp"
#include "rows.hpp"

namespace armcmc::log_export {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Json = nlohmann::ordered_json;

constexpr std::int64_t kLastUtime = std::numeric_limits<std::int64_t>::max() / 1000;

/// A damaged log may hold any time; MCAP has none before zero.
std::uint64_t Nanoseconds(std::int64_t utime) {
  return static_cast<std::uint64_t>(std::clamp<std::int64_t>(utime, 0, kLastUtime)) * 1000U;
}

/// JSON Schema of a row. Viewers read a subset: one type for a value, and no array but of plain values; that a number
/// may be null is therefore said in words.
std::string SchemaText(const MessageType& type, const std::vector<Column>& columns, bool per_sample) {
  Json schema;
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["title"] = "armcmc." + type.name;
  schema["description"] = std::string(per_sample ? "One message per sample." : "One message per message of the log.") +
                          " Descriptions name the unit. A number that is not finite is null.";
  schema["type"] = "object";
  schema["properties"] = Json::object();
  for (const Column& column : columns) {
    Json* at = &schema;
    const std::size_t names = column.path.size() - (column.bin ? 1 : 0);
    for (std::size_t i = 0; i < names; ++i) {
      at = &(*at)["properties"][column.path[i]];
      if (i + 1 < names) (*at)["type"] = "object";
    }
    if (column.bin) {
      (*at)["type"] = "array";
      if (!column.unit.empty()) (*at)["description"] = column.unit;
      at = &(*at)["items"];
    } else if (!column.unit.empty()) {
      (*at)["description"] = column.unit;
    }
    (*at)["type"] = column.text ? "string" : IsReal(*column.field) ? "number" : "integer";
  }
  return schema.dump();
}

/// What stands in front of each value of a row, and behind the last one: the same for every row.
std::vector<std::string> Frame(const std::vector<Column>& columns) {
  std::vector<std::string> frame;
  std::vector<std::string> open;  // names of the objects and the array that are open
  std::string closing;            // what ends them, the innermost first
  std::string text = "{";
  bool first = true;
  for (const Column& column : columns) {
    std::vector<std::string> parents(column.path.begin(), column.path.end() - 1);
    std::size_t common = 0;
    while (common < std::min(open.size(), parents.size()) && open[common] == parents[common]) ++common;
    for (; open.size() > common; open.pop_back(), closing.erase(0, 1)) text.push_back(closing.front());
    if (!first) text.push_back(',');
    first = false;
    while (open.size() < parents.size()) {
      const bool array = column.bin && open.size() + 1 == parents.size();
      text += Json(parents[open.size()]).dump() + (array ? ":[" : ":{");
      open.push_back(parents[open.size()]);
      closing.insert(closing.begin(), array ? ']' : '}');
    }
    if (!column.bin) text += Json(column.path.back()).dump() + ":";
    frame.push_back(std::move(text));
    text.clear();
  }
  frame.push_back(text + closing + "}");
  return frame;
}

/// us, CLOCK_REALTIME of the sender; nullptr where the type does not say.
const MessageField* SendTime(const MessageType& type) {
  for (const MessageField& field : type.fields)
    if (field.name == "utime" || field.name.ends_with("_utime")) return &field;
  return nullptr;
}

class Topic final : public Sink {
 public:
  Topic(McapWriter* writer, std::int64_t first_utime, const ChannelScan& channel, const PlantScan& plant)
      : writer_(writer),
        first_utime_(first_utime),
        columns_(ColumnsOf(channel, plant)),
        rows_(channel, plant, columns_),
        frame_(Frame(columns_)),
        send_time_(SendTime(*channel.type)) {}

  [[nodiscard]] std::string Schema(const MessageType& type) const {
    return SchemaText(type, columns_, rows_.per_sample());
  }
  void UseChannel(std::uint16_t channel) { message_.channel = channel; }

  void Write(Bytes data, const MessageType& type, const EventTime& time) override {
    rows_.ForEach(data, type, time.t, [&](double t, std::size_t sample) { WriteRow(data, time.utime, t, sample); });
  }

  std::int64_t Close() override { return message_.sequence; }

 private:
  void WriteRow(Bytes data, std::int64_t utime, double t, std::size_t sample) {
    message_.log_time_ns = message_.publish_time_ns = Nanoseconds(utime);
    if (rows_.per_sample()) {
      message_.log_time_ns = message_.publish_time_ns = SampleTime(t, utime);
    } else if (send_time_ != nullptr) {
      // A log may have been played and recorded again, or the clock of the sender be another one.
      const std::uint64_t sent = Nanoseconds(IntegerAt(data, *send_time_, 0));
      const std::uint64_t apart =
          sent > message_.log_time_ns ? sent - message_.log_time_ns : message_.log_time_ns - sent;
      if (sent > 0 && apart <= 1'000'000'000U) message_.publish_time_ns = sent;
    }
    text_.clear();
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      text_ += frame_[i];
      AppendValue(data, columns_[i], columns_[i].index + sample * columns_[i].sample_stride);
    }
    text_ += frame_.back();
    message_.data = text_;
    writer_->Write(message_);
    ++message_.sequence;
  }

  /// @param t  s, since the first event of the log.
  [[nodiscard]] std::uint64_t SampleTime(double t, std::int64_t utime) const {
    constexpr double kLongest = 1e9;  // s; a plant time beyond is damaged
    if (!(std::abs(t) < kLongest)) return Nanoseconds(utime);
    const auto since = static_cast<std::int64_t>(std::llround(1e9 * t));
    const auto start = static_cast<std::int64_t>(Nanoseconds(first_utime_));
    if (since < 0) return static_cast<std::uint64_t>(std::max<std::int64_t>(start + since, 0));
    return static_cast<std::uint64_t>(start) + static_cast<std::uint64_t>(since);
  }

  void AppendValue(Bytes data, const Column& column, std::size_t index) {
    if (column.text) {
      text_ += Json(TextAt(data, *column.field, index)).dump();
    } else if (!IsReal(*column.field)) {
      AppendNumber(IntegerAt(data, *column.field, index), &text_);
    } else if (const double value = NumberAt(data, *column.field, index); std::isfinite(value)) {
      AppendNumber(value, &text_);
    } else {
      text_ += "null";
    }
  }

  McapWriter* writer_;
  std::int64_t first_utime_;
  std::vector<Column> columns_;
  Rows rows_;
  std::vector<std::string> frame_;
  const MessageField* send_time_;
  McapMessage message_;
  std::string text_;
};

}  // namespace

std::unique_ptr<Sink> McapTopics::New(const ChannelScan& channel, const PlantScan& plant) {
  auto topic = std::make_unique<Topic>(writer_, first_utime_, channel, plant);
  Schema schema = {channel.type->name, topic->Schema(*channel.type), 0};
  const auto same_type = [&](const Schema& s) { return s.type == schema.type; };
  const auto known = std::find_if(schemas_.begin(), schemas_.end(),
                                  [&](const Schema& s) { return same_type(s) && s.text == schema.text; });
  if (known == schemas_.end()) {
    // Readers know a schema by its name.
    const bool other = std::any_of(schemas_.begin(), schemas_.end(), same_type);
    const std::string name = "armcmc." + schema.type + (other ? "." + channel.name : "");
    schema.id = writer_->AddSchema(name, "jsonschema", schema.text);
    schemas_.push_back(schema);
  } else {
    schema.id = known->id;
  }
  topic->UseChannel(writer_->AddChannel(schema.id, channel.name, "json"));
  return topic;
}

}  // namespace armcmc::log_export
