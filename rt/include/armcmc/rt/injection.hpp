#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/counters.hpp"
#include "armcmc/rt/event_log.hpp"

namespace armcmc::rt {

/// Faults that the process makes itself, on purpose, to test what becomes of them. Never in service.
enum class InjectionKind : std::uint8_t {
  kOverrunCollect,  ///< The stage computes for so many ms more.
  kOverrunAdjust,
  kOverrunExecute,
  kHangCollect,  ///< The stage stands still for so many ms.
  kHangAdjust,
  kHangExecute,
  kSqueeze,   ///< Adjust gets no time: the draws are cut at once.
  kCollapse,  ///< The posterior is driven into a wrong point, many times.
  kPublish,   ///< The next so many publications are not sent.
};
inline constexpr std::size_t kNumInjectionKinds = 9;
[[nodiscard]] std::string_view ToString(InjectionKind kind) noexcept;

struct InjectionItem {
  InjectionKind kind = InjectionKind::kSqueeze;
  std::int64_t pack = 0;    ///< Number of the pack at which it happens, >= 1; in every run of the plant again.
  std::int64_t amount = 0;  ///< ms of overruns and hangs, [1, 60000]; messages of kPublish, [1, 1000]; else 0.
};

/// From `hang_adjust@60:300,squeeze@70`: `kind@pack`, with an amount where the kind has one.
/// @throws std::invalid_argument naming the item that is not understood and what is allowed.
[[nodiscard]] std::vector<InjectionItem> ParseInjections(const std::string& list);

/// Carries a plan out. Each stage asks at its own hook; an empty plan does nothing.
class Injection {
 public:
  explicit Injection(std::vector<InjectionItem> plan) : plan_(std::move(plan)) {}

  /// Where the stages' events go: collect, adjust, execute, publish. Before the threads start.
  void SetEventLogs(std::array<EventLog*, 4> logs) noexcept { logs_ = logs; }

  /// Overruns and hangs of a stage. Blocks or spins as long as the plan says: that is what it is for.
  void Disturb(Stage stage, std::int64_t pack) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] bool Squeezes(std::int64_t pack) noexcept ARMCMC_NONBLOCKING {
    return Take(InjectionKind::kSqueeze, pack, 1) != nullptr;
  }
  [[nodiscard]] bool Collapses(std::int64_t pack) noexcept ARMCMC_NONBLOCKING {
    return Take(InjectionKind::kCollapse, pack, 1) != nullptr;
  }
  /// @return true when this publication is not to be sent. @param pack  Newest pack, 0 for a status without one.
  [[nodiscard]] bool FailsPublication(std::int64_t pack) noexcept ARMCMC_NONBLOCKING;

  /// How often each kind was carried out.
  [[nodiscard]] std::int64_t count(InjectionKind kind) const noexcept {
    return counts_[static_cast<std::size_t>(kind)].Get();
  }

 private:
  const InjectionItem* Take(InjectionKind kind, std::int64_t pack, std::size_t log) noexcept ARMCMC_NONBLOCKING;

  std::vector<InjectionItem> plan_;
  std::array<EventLog*, 4> logs_{};
  std::array<Counter, kNumInjectionKinds> counts_;  // each kind has one thread that counts it
  std::int64_t publications_to_fail_ = 0;
  std::int64_t failed_at_pack_ = 0;
};

}  // namespace armcmc::rt
