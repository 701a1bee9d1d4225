#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/support/csv.hpp"
#include "plants/hunt_crossley/model.hpp"

namespace armcmc::replay {

inline constexpr double kDt = 0.001;

/// A contact with K = 4, B = 2.3, p = 1.7 and a deterministic error of about 0.1 N in place of noise.
struct ContactSample {
  double t, x, v, f;
};
inline ContactSample ContactAt(int i) {
  const double t = i * kDt;
  const double x = 0.5 + 0.5 * std::sin(3.0 * t), v = 1.5 * std::cos(3.0 * t);
  return {t, x, v, std::pow(x, 1.7) * (4.0 + 2.3 * v) + 0.1 * std::sin(12.9898 * i * i)};
}

inline std::string ContactCsv(int rows) {
  using support::ExactNumber;
  std::string text = "t,x,v,f\n";
  for (int i = 0; i < rows; ++i) {
    const ContactSample s = ContactAt(i);
    // Times as a logger writes them, in decimals.
    text += std::to_string(i / 1000) + "." + std::to_string(1000 + i % 1000).substr(1) + "," + ExactNumber(s.x) + "," +
            ExactNumber(s.v) + "," + ExactNumber(s.f) + "\n";
  }
  return text;
}

/// Of contact packs, but for the file.
inline SourceRequest ContactRequest() {
  SourceRequest request;
  request.plant = HuntCrossley::kInfo.plant;
  request.num_inputs = HuntCrossley::kInfo.num_inputs;
  request.mode_names = {"contact"};
  return request;
}

/// Pack `seq` of the same contact, as the plant sends it.
inline data_pack_t ContactPack(std::int64_t seq, std::int64_t run_id = 77) {
  data_pack_t pack{};
  pack.seq = seq;
  pack.run_id = run_id;
  pack.dt = kDt;
  pack.plant_kind = data_pack_t::PLANT_HUNT_CROSSLEY;
  pack.n_samples = 100;
  pack.n_inputs = 2;
  for (int n = 0; n < 100; ++n) {
    const ContactSample s = ContactAt(static_cast<int>(seq - 1) * 100 + 1 + n);
    pack.u[n][0] = s.x;
    pack.u[n][1] = s.v;
    pack.y[n] = s.f;
    pack.t_last_s = s.t;
  }
  return pack;
}

/// Writes messages to an LCM log.
class LogWriter {
 public:
  explicit LogWriter(const std::filesystem::path& path) : log_(path, "w") {}

  template <typename Message>
  void Write(const std::string& channel, const Message& message) {
    std::vector<char> data(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(data.data(), 0, static_cast<int>(data.size()));
    WriteBytes(channel, &data);
  }
  /// An event that is no message of ours.
  void WriteRaw(const std::string& channel, const std::string& text) {
    std::vector<char> data(text.begin(), text.end());
    WriteBytes(channel, &data);
  }
  /// What was written so far can be read.
  void Flush() { std::fflush(log_.getFilePtr()); }

 private:
  void WriteBytes(const std::string& channel, std::vector<char>* data) {
    lcm::LogEvent event{};
    event.timestamp = ++utime_;
    event.channel = channel;
    event.datalen = static_cast<std::int32_t>(data->size());
    event.data = data->data();
    log_.writeEvent(&event);
  }

  lcm::LogFile log_;
  std::int64_t utime_ = 0;
};

}  // namespace armcmc::replay
