#include "integration/bus_recorder.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <utility>

#include "armcmc/data_pack_t.hpp"

namespace armcmc::test {

BusRecorder::BusRecorder(const std::string& url, const std::filesystem::path& log, std::string prefix)
    : prefix_(std::move(prefix)), bus_(url + "&recv_buf_size=4194304"), log_(log, "w") {
  if (!bus_.good() || !log_.good()) throw std::runtime_error("cannot record " + url);
  bus_.subscribeFunction(".*", &BusRecorder::OnMessage, this)->setQueueCapacity(1000);
  if (bus_.getFileno() < 0) throw std::runtime_error("cannot listen on " + url);
  thread_ = std::thread([this] {
    while (!stop_.load()) bus_.handleTimeout(20);
  });
}

void BusRecorder::Stop() {
  if (!thread_.joinable()) return;
  stop_.store(true);
  thread_.join();
  // What was sent before this call is in the file, the end of the last message included; a plant may go on for ever.
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(200);
  while (bus_.handleTimeout(10) > 0 && std::chrono::steady_clock::now() < end) {
  }
  std::fflush(log_.getFilePtr());
}

void BusRecorder::OnMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel, BusRecorder* self) {
  self->Record(buffer, channel);
}

void BusRecorder::Record(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
  if (channel == "LCM_SELF_TEST") return;
  lcm::LogEvent event{};
  event.timestamp = buffer->recv_utime;
  event.channel = channel;
  event.datalen = static_cast<std::int32_t>(buffer->data_size);
  event.data = buffer->data;
  log_.writeEvent(&event);

  const std::scoped_lock lock(mutex_);
  const int size = static_cast<int>(buffer->data_size);
  if (channel == prefix_ + "EST_ESTIMATE") {
    estimate_t estimate{};
    if (estimate.decode(buffer->data, 0, size) >= 0) estimates_.push_back(estimate);
  } else if (channel == prefix_ + "EST_STATUS") {
    estimator_status_t status{};
    if (status.decode(buffer->data, 0, size) >= 0) statuses_.push_back(status);
  } else if (channel == prefix_ + "PLANT_PACK") {
    const auto pack = std::make_unique<data_pack_t>();
    if (pack->decode(buffer->data, 0, size) >= 0) last_pack_ns_ = std::max(last_pack_ns_, pack->t_last_ns);
  }
}

std::vector<estimate_t> BusRecorder::estimates() const {
  const std::scoped_lock lock(mutex_);
  return estimates_;
}

std::vector<estimator_status_t> BusRecorder::statuses() const {
  const std::scoped_lock lock(mutex_);
  return statuses_;
}

std::int64_t BusRecorder::last_pack_ns() const {
  const std::scoped_lock lock(mutex_);
  return last_pack_ns_;
}

bool BusRecorder::WaitUntil(const std::function<bool()>& condition) const {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (std::chrono::steady_clock::now() < end) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

bool BusRecorder::WaitForEstimates(std::size_t count) const {
  return WaitUntil([&] {
    const std::scoped_lock lock(mutex_);  // without a copy of them all
    return estimates_.size() >= count;
  });
}

}  // namespace armcmc::test
