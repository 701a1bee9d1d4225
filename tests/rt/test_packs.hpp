#pragma once

#include <cstdint>
#include <vector>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/data_pack_v2_t.hpp"

namespace armcmc::rt::test {

/// A valid Hunt-Crossley pack of 100 samples at 1 ms.
inline data_pack_t ValidPack(std::int64_t seq, std::int64_t run_id = 1) {
  data_pack_t pack{};
  pack.utime = 1;
  pack.seq = seq;
  pack.run_id = run_id;
  pack.t_last_ns = 100'000'000 * seq;
  pack.t_last_s = 0.1 * static_cast<double>(seq) - 0.001;
  pack.dt = 1e-3;
  pack.plant_kind = data_pack_t::PLANT_HUNT_CROSSLEY;
  pack.n_samples = 100;
  pack.n_inputs = 2;
  for (int n = 0; n < pack.n_samples; ++n) {
    pack.y[n] = 0.1 * n;
    pack.u[n][0] = 0.01 * n;
    pack.u[n][1] = 0.5;
  }
  return pack;
}

/// A valid pack of a plant that a file describes: "axis" with three inputs.
inline data_pack_v2_t ValidDescribedPack(std::int64_t seq, std::int64_t run_id = 1) {
  data_pack_v2_t pack{};
  pack.pack_utime = 1;
  pack.seq = seq;
  pack.run_id = run_id;
  pack.t_last_ns = 100'000'000 * seq;
  pack.t_last_s = 0.1 * static_cast<double>(seq) - 0.001;
  pack.dt = 1e-3;
  const char name[] = "axis";
  for (std::size_t i = 0; i + 1 < sizeof name; ++i) pack.plant[i] = static_cast<std::uint8_t>(name[i]);
  pack.fingerprint = -7;
  pack.n_samples = 100;
  pack.n_inputs = 3;
  for (int n = 0; n < pack.n_samples; ++n) {
    pack.y[n] = 0.1 * n;
    for (int i = 0; i < pack.n_inputs; ++i) pack.u[n][i] = 0.01 * n + i;
  }
  return pack;
}

template <typename Message>
std::vector<std::uint8_t> Encode(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace armcmc::rt::test
