#pragma once

#include <lcm/lcm.h>

#include <cstdint>
#include <memory>
#include <string>

#include "armcmc/estimate_t.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/plant_sim/message_sink.hpp"

namespace armcmc::plant_sim {

struct LcmDeleter {
  void operator()(lcm_t* lcm) const noexcept { lcm_destroy(lcm); }
};
using LcmHandle = std::unique_ptr<lcm_t, LcmDeleter>;

/// Opens a bus. @throws std::invalid_argument for a URL that names no provider of LCM, std::runtime_error with
/// the remedy when the bus cannot be opened, a missing multicast route among the reasons.
[[nodiscard]] LcmHandle OpenLcm(const std::string& url);

/// Sends on a bus. It has its own handle and never receives: nothing that arrives can hold it up.
class LcmSink final : public MessageSink {
 public:
  explicit LcmSink(const std::string& url) : lcm_(OpenLcm(url)) {}
  bool Send(const char* channel, const void* data, int size, std::int64_t /*utime*/) noexcept override {
    return lcm_publish(lcm_.get(), channel, data, static_cast<unsigned>(size)) == 0;
  }

 private:
  LcmHandle lcm_;
};

/// Receives estimates and the estimator's status on a handle of its own, in the thread that calls Poll.
class EstimateListener {
 public:
  class Handler {
   public:
    virtual ~Handler() = default;
    virtual void OnEstimate(const estimate_t& estimate) = 0;
    virtual void OnStatus(const estimator_status_t& status) = 0;
  };

  /// @throws std::runtime_error when the bus cannot be opened or subscribed to.
  EstimateListener(const std::string& url, const std::string& prefix, Handler* handler);

  /// Waits up to timeout_ms for a message and hands on all that have come.
  void Poll(int timeout_ms);
  /// Messages on these channels that did not decode.
  [[nodiscard]] std::int64_t undecodable() const noexcept { return undecodable_; }

 private:
  static void OnEstimateBytes(const lcm_recv_buf_t* buffer, const char* channel, void* self);
  static void OnStatusBytes(const lcm_recv_buf_t* buffer, const char* channel, void* self);

  LcmHandle lcm_;
  Handler* handler_;
  estimate_t estimate_{};
  estimator_status_t status_{};
  std::int64_t undecodable_ = 0;
};

}  // namespace armcmc::plant_sim
