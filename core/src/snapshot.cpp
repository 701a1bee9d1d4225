#include "armcmc/snapshot.hpp"

#include <string>

#include "armcmc/plant/program.hpp"

namespace armcmc {
namespace {

/// Changed whenever the data that Save() writes, or the settings that identify a model, change.
constexpr std::int64_t kLayout = 3;

/// FNV-1a, 64 bits.
class Hash {
 public:
  void Bytes(const void* data, std::size_t size) noexcept {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) value_ = (value_ ^ bytes[i]) * 0x100000001b3ULL;
  }
  void Add(const std::string& text) noexcept { Bytes(text.c_str(), text.size() + 1); }
  void Add(double number) noexcept { Bytes(&number, sizeof number); }
  void Add(int number) noexcept { Bytes(&number, sizeof number); }
  void Add(const ParameterSettings& p) noexcept {
    Add(p.name);
    Add(static_cast<int>(p.prior));
    for (const double v : {p.mean, p.sd, p.lower, p.upper}) Add(v);
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace

std::uint64_t SnapshotIdentity(const EstimatorSettings& s) noexcept {
  Hash hash;
  hash.Bytes(&kLayout, sizeof kLayout);
  hash.Add(s.model);
  if (s.plant != nullptr) {
    const std::uint64_t plant = s.plant->plant().identity();
    hash.Bytes(&plant, sizeof plant);
  }
  hash.Add(s.num_parameters);
  for (int i = 0; i < s.num_parameters; ++i) hash.Add(s.parameters[static_cast<std::size_t>(i)]);
  for (const NoiseSettings& n : s.noise) {
    hash.Add(static_cast<int>(n.kind));
    hash.Add(n.estimate_std ? 1 : 0);
    for (const double v : {n.std, n.mean, n.std_log_sd, n.dof, n.outlier_weight, n.outlier_scale}) hash.Add(v);
  }
  for (const double v : s.constants) hash.Add(v);
  hash.Add(s.regress_rate ? 1 : 0);
  hash.Add(s.num_effects);
  for (int i = 0; i < s.num_effects; ++i) {
    const EffectSettings& e = s.effects[static_cast<std::size_t>(i)];
    hash.Add(e.name);
    hash.Add(static_cast<int>(e.gate));
    hash.Add(e.from_s);
    hash.Add(e.until_s);
    for (const ParameterSettings& a : e.amplitudes) hash.Add(a);
    for (const double v : e.shapes) hash.Add(v);
  }
  if (s.overlap > 1) hash.Add(s.overlap);
  return hash.value();
}

}  // namespace armcmc
