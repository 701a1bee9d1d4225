#include "armcmc/rt/injection.hpp"

#include <charconv>
#include <sstream>
#include <stdexcept>

#include "armcmc/rt/clock.hpp"

namespace armcmc::rt {
namespace {

constexpr std::size_t kPublishLog = 3;

constexpr bool HasAmount(InjectionKind kind) noexcept {
  return kind != InjectionKind::kSqueeze && kind != InjectionKind::kCollapse;
}

[[noreturn]] void Reject(const std::string& item) {
  throw std::invalid_argument("\"" + item +
                              "\" is not an injection: expected overrun_STAGE@K:MS or hang_STAGE@K:MS with STAGE "
                              "collect, adjust or execute, squeeze@K, collapse@K or publish@K:N, with a pack number "
                              "K >= 1, milliseconds MS in [1, 60000] and messages N in [1, 1000]");
}

std::int64_t Number(std::string_view text, std::int64_t most, const std::string& item) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 1 || value > most) Reject(item);
  return value;
}

InjectionItem ParseItem(const std::string& text) {
  const std::size_t at = text.find('@');
  if (at == std::string::npos) Reject(text);
  InjectionItem item;
  std::size_t kind = 0;
  while (kind < kNumInjectionKinds && ToString(static_cast<InjectionKind>(kind)) != text.substr(0, at)) ++kind;
  if (kind == kNumInjectionKinds) Reject(text);
  item.kind = static_cast<InjectionKind>(kind);
  const std::string_view rest = std::string_view(text).substr(at + 1);
  const std::size_t colon = rest.find(':');
  if ((colon != std::string_view::npos) != HasAmount(item.kind)) Reject(text);
  item.pack = Number(rest.substr(0, colon), std::int64_t{1} << 62U, text);
  if (HasAmount(item.kind)) {
    item.amount = Number(rest.substr(colon + 1), item.kind == InjectionKind::kPublish ? 1000 : 60'000, text);
  }
  return item;
}

}  // namespace

std::string_view ToString(InjectionKind kind) noexcept {
  switch (kind) {
    case InjectionKind::kOverrunCollect: return "overrun_collect";
    case InjectionKind::kOverrunAdjust: return "overrun_adjust";
    case InjectionKind::kOverrunExecute: return "overrun_execute";
    case InjectionKind::kHangCollect: return "hang_collect";
    case InjectionKind::kHangAdjust: return "hang_adjust";
    case InjectionKind::kHangExecute: return "hang_execute";
    case InjectionKind::kSqueeze: return "squeeze";
    case InjectionKind::kCollapse: return "collapse";
    case InjectionKind::kPublish: return "publish";
  }
  return "unknown";
}

std::vector<InjectionItem> ParseInjections(const std::string& list) {
  std::vector<InjectionItem> plan;
  if (list.empty()) return plan;
  std::istringstream items(list);
  for (std::string item; std::getline(items, item, ',');) plan.push_back(ParseItem(item));
  if (list.back() == ',') Reject("");
  return plan;
}

const InjectionItem* Injection::Take(InjectionKind kind, std::int64_t pack, std::size_t log) noexcept {
  for (const InjectionItem& item : plan_) {
    if (item.kind != kind || item.pack != pack) continue;
    counts_[static_cast<std::size_t>(kind)].Add();
    if (logs_[log] != nullptr) {
      logs_[log]->Add({MonotonicNow(), EventKind::kInjected, static_cast<std::uint8_t>(kind), pack, item.amount});
    }
    return &item;
  }
  return nullptr;
}

void Injection::Disturb(Stage stage, std::int64_t pack) noexcept {
  const auto i = static_cast<std::uint8_t>(stage);
  const auto overrun = static_cast<InjectionKind>(static_cast<std::uint8_t>(InjectionKind::kOverrunCollect) + i);
  const auto hang = static_cast<InjectionKind>(static_cast<std::uint8_t>(InjectionKind::kHangCollect) + i);
  if (const InjectionItem* item = Take(overrun, pack, i); item != nullptr) {
    for (const Nanos end = MonotonicNow() + item->amount * kNanosPerMilli; MonotonicNow() < end;) {
    }
  }
  if (const InjectionItem* item = Take(hang, pack, i); item != nullptr) {
    SleepUntil(MonotonicNow() + item->amount * kNanosPerMilli);
  }
}

bool Injection::FailsPublication(std::int64_t pack) noexcept {
  if (pack > 0 && pack != failed_at_pack_) {
    if (const InjectionItem* item = Take(InjectionKind::kPublish, pack, kPublishLog); item != nullptr) {
      failed_at_pack_ = pack;
      publications_to_fail_ = item->amount;
    } else {
      failed_at_pack_ = 0;
    }
  }
  if (publications_to_fail_ == 0) return false;
  --publications_to_fail_;
  return true;
}

}  // namespace armcmc::rt
