#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace armcmc::plant_sim {

enum class FaultKind : std::uint8_t {
  kNan,        ///< The middle sample of the output is NaN.
  kSize,       ///< n_samples is one more than a pack can hold.
  kDuplicate,  ///< The pack is sent twice.
  kReorder,    ///< The pack is sent after the next one.
  kDrop,       ///< The pack is not sent.
  kForeign,    ///< A message of another type is sent on the same channel, before the pack.
  kGarbage,    ///< Bytes that no type decodes are sent on the same channel, before the pack.
  kLate,       ///< The pack is sent late.
  kZero,       ///< Every value of the pack is zero.
  kHuge,       ///< The middle sample of the output is 1e300.
  kCorrupt,    ///< Every byte behind the type of the message is damaged.
  kClock,      ///< The plant's clock jumps, and stays so.
};

struct Fault {
  FaultKind kind = FaultKind::kNan;
  std::int64_t pack = 0;   ///< seq, >= 1.
  double amount_ms = 0.0;  ///< kLate and kClock only, > 0.
};

[[nodiscard]] std::string_view ToString(FaultKind kind) noexcept;

/// Faults to inject on purpose, at given packs.
class FaultPlan {
 public:
  FaultPlan() = default;
  /// From "nan@12,late@30:40": kind@pack, and for late and clock the milliseconds.
  /// @throws std::invalid_argument naming the item that is not understood and what is allowed.
  static FaultPlan Parse(const std::string& list);

  [[nodiscard]] bool Has(FaultKind kind, std::int64_t pack) const noexcept { return Find(kind, pack) != nullptr; }
  /// Delay of a pack in ms, 0 when it is not late.
  [[nodiscard]] double LateMs(std::int64_t pack) const noexcept;
  /// By how much the plant's clock is ahead at a pack, in ms.
  [[nodiscard]] double ClockMs(std::int64_t pack) const noexcept;
  [[nodiscard]] const std::vector<Fault>& faults() const noexcept { return faults_; }

 private:
  [[nodiscard]] const Fault* Find(FaultKind kind, std::int64_t pack) const noexcept;
  std::vector<Fault> faults_;
};

}  // namespace armcmc::plant_sim
