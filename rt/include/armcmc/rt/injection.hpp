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

/// Faults that the process injects into itself, to test how it detects them and recovers. For test runs only.
enum class InjectionKind : std::uint8_t {
  kOverrunCollect,  ///< The stage computes for so many ms more.
  kOverrunAdjust,   ///< The same for adjust.
  kOverrunExecute,  ///< The same for execute.
  kHangCollect,     ///< The stage stands still for so many ms.
  kHangAdjust,      ///< The same for adjust.
  kHangExecute,     ///< The same for execute.
  kSqueeze,         ///< Adjust gets no time: the draws are cut at once.
  kCollapse,        ///< The posterior is driven into a wrong point, many times.
  kPublish,         ///< The next so many publications are not sent.
};
/// Number of kinds.
inline constexpr std::size_t kNumInjectionKinds = 9;
/// Name of a kind as in a plan, "hang_adjust".
[[nodiscard]] std::string_view ToString(InjectionKind kind) noexcept;

/// One entry of a plan: what happens, at which pack, and how long or how often.
struct InjectionItem {
  InjectionKind kind = InjectionKind::kSqueeze;
  std::int64_t pack = 0;    ///< Number of the pack at which it happens, >= 1; in every run of the plant again.
  std::int64_t amount = 0;  ///< ms of overruns and hangs, [1, 60000]; messages of kPublish, [1, 1000]; else 0.
};

/// Parses a plan such as `hang_adjust@60:300,squeeze@70`: `kind@pack`, with `:amount` for the kinds that have one.
/// @throws std::invalid_argument  naming the item that is not understood, and what is allowed.
[[nodiscard]] std::vector<InjectionItem> ParseInjections(const std::string& list);

/// Carries out a plan. Each stage asks at its own hook whether a fault is due; with an empty plan the hooks do nothing.
/// Every kind is asked for by one thread only. What is carried out is counted, and recorded in the event log of the
/// stage.
class Injection {
 public:
  /// @param plan  From ParseInjections().
  explicit Injection(std::vector<InjectionItem> plan) : plan_(std::move(plan)) {}

  /// Where the stages' events go: collect, adjust, execute, publish. Before the threads start.
  void SetEventLogs(std::array<EventLog*, 4> logs) noexcept { logs_ = logs; }

  /// Overruns and hangs of a stage: an overrun spins, a hang sleeps. Blocks as long as the plan says: that is what it
  /// is for.
  /// @param stage  Which one calls. @param pack  Number of the pack that it works on.
  void Disturb(Stage stage, std::int64_t pack) noexcept ARMCMC_NONBLOCKING;
  /// Whether the draws of this pack are to be cut at once. By adjust. @rt No heap, no lock, no throw. O(plan).
  [[nodiscard]] bool CutsDraws(std::int64_t pack) noexcept ARMCMC_NONBLOCKING {
    return Take(InjectionKind::kSqueeze, pack, 1) != nullptr;
  }
  /// Whether the posterior is to be driven into a wrong point after this pack. By adjust. @rt As CutsDraws().
  [[nodiscard]] bool Collapses(std::int64_t pack) noexcept ARMCMC_NONBLOCKING {
    return Take(InjectionKind::kCollapse, pack, 1) != nullptr;
  }
  /// @return true when this publication is not to be sent. @param pack  Newest pack, 0 for a status without one.
  [[nodiscard]] bool FailsPublication(std::int64_t pack) noexcept ARMCMC_NONBLOCKING;

  /// How often each kind was carried out. Any time, from any thread.
  [[nodiscard]] std::int64_t count(InjectionKind kind) const noexcept {
    return counts_[static_cast<std::size_t>(kind)].Get();
  }

 private:
  /// The first entry of that kind for that pack, after counting and recording it; null if there is none.
  /// @param log  Index into logs_.
  const InjectionItem* Take(InjectionKind kind, std::int64_t pack, std::size_t log) noexcept ARMCMC_NONBLOCKING;

  std::vector<InjectionItem> plan_;
  std::array<EventLog*, 4> logs_{};
  std::array<Counter, kNumInjectionKinds> counts_;  // each kind has one thread that counts it
  std::int64_t publications_to_fail_ = 0;
  std::int64_t failed_at_pack_ = 0;
};

}  // namespace armcmc::rt
