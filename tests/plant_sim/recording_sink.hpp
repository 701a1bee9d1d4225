#pragma once

#include <string>
#include <vector>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/plant_sim/message_sink.hpp"

namespace armcmc::plant_sim {

/// Keeps what it is sent.
class RecordingSink final : public MessageSink {
 public:
  struct Message {
    std::string channel;
    std::vector<char> bytes;
    /// Pack number, -1 when the bytes are no pack.
    [[nodiscard]] std::int64_t Seq() const {
      data_pack_t pack{};
      return pack.decode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0 ? -1 : pack.seq;
    }
  };

  bool Send(const char* channel, const void* data, int size, std::int64_t /*utime*/) noexcept override {
    const char* begin = static_cast<const char*>(data);
    messages_.push_back({channel, {begin, begin + size}});
    return !broken_;
  }
  void Break() { broken_ = true; }

  /// Messages of one channel.
  [[nodiscard]] std::vector<Message> On(const std::string& channel) const {
    std::vector<Message> found;
    for (const Message& message : messages_)
      if (message.channel == channel) found.push_back(message);
    return found;
  }
  [[nodiscard]] std::vector<std::int64_t> Seqs(const std::string& channel) const {
    std::vector<std::int64_t> seqs;
    for (const Message& message : On(channel)) seqs.push_back(message.Seq());
    return seqs;
  }

 private:
  std::vector<Message> messages_;
  bool broken_ = false;
};

}  // namespace armcmc::plant_sim
