#include "armcmc/plant_sim/estimator_watch.hpp"

namespace armcmc::plant_sim {

bool EstimatorWatch::OnEstimate(std::int64_t now_ns) noexcept {
  const bool back = silent_;
  heard_ = true;
  silent_ = false;
  last_ns_ = now_ns;
  return back;
}

bool EstimatorWatch::NoticeSilence(std::int64_t now_ns) noexcept {
  if (!heard_ || silent_ || now_ns - last_ns_ <= limit_ns_) return false;
  silent_ = true;
  ++silences_;
  return true;
}

}  // namespace armcmc::plant_sim
