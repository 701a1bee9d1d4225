#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "armcmc/watch/watch_state.hpp"

namespace armcmc::test {

inline void SetText(const std::string& text, std::uint8_t* field) { std::copy(text.begin(), text.end(), field); }

inline estimator_status_t SomeStatus() {
  estimator_status_t s{};
  s.step = 12;
  s.last_seq = 11;
  s.period_ns = 100'000'000;
  s.deadline_ns = 100'000'000;
  s.collect_ns = 10'000;
  s.adjust_ns = 50'000'000;
  s.execute_ns = 1'000'000;
  s.end_to_end_ns = 52'000'000;
  s.slack_ns = 48'000'000;
  s.packs_received = 11;
  s.gap_watched = 1;
  s.gap_check = -1;
  return s;
}

inline estimate_t SomeEstimate() {
  estimate_t e{};
  e.plant_kind = data_pack_t::PLANT_HUNT_CROSSLEY;
  e.in_contact = e.known = 1;
  e.decision = estimate_t::DECISION_REINFORCEMENT;
  e.n_params = 1;
  e.n_modes = 1;
  SetText("K", e.param_name[0]);
  SetText("N/m^p", e.param_unit[0]);
  e.ar_ap[0] = 3.25;
  e.sd[0] = 0.5;
  e.q025[0] = 2.0;
  e.q975[0] = 4.5;
  e.lambda = 0.75;
  e.zeta = 0.25;
  e.zeta_threshold = 1.5;
  e.acceptance = 0.8;
  e.ess = 1234.4;
  return e;
}

inline posterior_t SomePosterior() {
  posterior_t p{};
  p.known = 1;
  p.n_params = 1;
  p.n_bins = 64;
  p.lo[0] = 2.0;
  p.hi[0] = 4.0;
  p.density[0][32] = 32.0;
  return p;
}

inline change_t SomeChange() {
  change_t c{};
  c.plant_kind = data_pack_t::PLANT_HUNT_CROSSLEY;
  c.n_modes = c.n_params = 1;
  SetText("contact", c.mode_name[0]);
  SetText("K", c.param_name[0]);
  SetText("N/m^p", c.param_unit[0]);
  c.known[0] = c.updated[0] = 1;
  c.p_persisted[0] = 0.25;
  c.p_drifted[0] = 0.625;
  c.p_changed[0] = 0.125;
  c.drift_rate[0][0] = 0.0375;
  return c;
}

inline plant_truth_t SomeTruth() {
  plant_truth_t t{};
  t.plant_kind = data_pack_t::PLANT_HUNT_CROSSLEY;
  t.n_params = 1;
  t.theta_true[0] = 3.5;
  return t;
}

inline watch::WatchState SomeState() {
  watch::WatchState state;
  state.url = "udpm://239.255.76.67:7667?ttl=0";
  state.Take(SomeEstimate(), 1.0);
  state.Take(SomePosterior(), 1.0);
  state.Take(SomeChange(), 1.0);
  state.Take(SomeTruth(), 1.0);
  state.Take(SomeStatus(), 1.0);
  return state;
}

template <typename Message>
std::vector<std::uint8_t> Encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace armcmc::test
