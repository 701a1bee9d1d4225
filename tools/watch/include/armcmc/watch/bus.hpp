#pragma once

#include <lcm/lcm.h>

#include <functional>
#include <memory>
#include <string>

namespace armcmc::watch {

/// Listens to the channels of one estimator and its plant through liblcm.
class Bus {
 public:
  /// Gets the channel without the prefix, and the message.
  using Handler = std::function<void(const std::string& name, const void* bytes, int size)>;

  /// @throws std::invalid_argument for a URL that is none, std::runtime_error with the remedy when the machine has no
  ///         multicast route.
  Bus(const std::string& url, std::string prefix, Handler handler);
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Readable when there is a message.
  [[nodiscard]] int fd() const { return fd_; }
  /// Hands over what has come, at most `most` messages; never waits.
  void Drain(int most);

 private:
  struct Destroy {
    void operator()(lcm_t* lcm) const noexcept { lcm_destroy(lcm); }
  };
  static void OnMessage(const lcm_recv_buf_t* buffer, const char* channel, void* self);

  std::string prefix_;
  Handler handler_;
  std::unique_ptr<lcm_t, Destroy> lcm_;
  int fd_ = -1;
};

}  // namespace armcmc::watch
