#include "armcmc/stress/bus_watch.hpp"

#include <chrono>
#include <stdexcept>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/stress/stressed_plant.hpp"

namespace armcmc::stress {
namespace {

constexpr int kQueue = 4000;  // messages: two seconds at 1 kHz

}  // namespace

BusWatch::BusWatch(const std::string& url, const std::string& prefix) : bus_(url) {
  if (!bus_.good()) throw std::runtime_error("cannot open the bus " + url + ": has multicast a route?");
  bus_.subscribeFunction(prefix + "PLANT_PACK", &BusWatch::OnPack, this)->setQueueCapacity(kQueue);
  bus_.subscribeFunction(prefix + "EST_ESTIMATE", &BusWatch::OnEstimate, this)->setQueueCapacity(kQueue);
  bus_.subscribeFunction(prefix + "EST_STATUS", &BusWatch::OnStatus, this)->setQueueCapacity(kQueue);
}

void BusWatch::Poll(int ms, FaultJudge* judge) {
  judge_ = judge;
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(ms);
  for (int left = ms; left > 0;) {
    if (bus_.handleTimeout(left) <= 0) return;
    left = static_cast<int>(
        std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now()).count());
  }
}

void BusWatch::BeginPhase() {
  end_to_end_ = {};
  statuses_ = last_step_ = 0;
}

void BusWatch::OnPack(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/, BusWatch* self) {
  // Decoded by hand, since many are damaged on purpose.
  data_pack_t pack{};
  if (pack.decode(buffer->data, 0, static_cast<int>(buffer->data_size)) < 0) return;
  if (pack.plant_kind != PlantUnderStress().number) return;
  self->newest_pack_ = std::max(self->newest_pack_, pack.seq);
}

void BusWatch::OnEstimate(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
                          const estimate_t* message, BusWatch* self) {
  if (self->judge_ != nullptr) self->judge_->OnEstimate(*message);
}

void BusWatch::OnStatus(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
                        const estimator_status_t* message, BusWatch* self) {
  ++self->statuses_;
  if (message->step > self->last_step_) {
    self->last_step_ = message->step;
    self->end_to_end_.Add(message->end_to_end_ns);
  }
  if (self->recorder_ != nullptr) self->recorder_->Add(*message);
  if (self->judge_ != nullptr) self->judge_->OnStatus(*message);
}

}  // namespace armcmc::stress
