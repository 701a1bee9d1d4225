#include "armcmc/support/parallel.hpp"

#include <array>
#include <atomic>
#include <exception>
#include <thread>

namespace armcmc::support {
namespace {

thread_local bool inside = false;

}  // namespace

void InParallel(std::size_t count, const std::function<void(std::size_t)>& work) {
  if (inside || count < 2) {
    for (std::size_t i = 0; i < count; ++i) work(i);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::array<std::exception_ptr, 2> thrown;
  const auto loop = [&](std::size_t which) {
    inside = true;
    try {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      thrown[which] = std::current_exception();
      next = count;
    }
    inside = false;
  };
  std::thread other(loop, 1);
  loop(0);
  other.join();
  for (const std::exception_ptr& exception : thrown)
    if (exception) std::rethrow_exception(exception);
}

}  // namespace armcmc::support
