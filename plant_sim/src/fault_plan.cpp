#include "armcmc/plant_sim/fault_plan.hpp"

#include <array>
#include <charconv>
#include <sstream>
#include <stdexcept>

namespace armcmc::plant_sim {
namespace {

constexpr std::array kFaultKinds = {FaultKind::kNan,  FaultKind::kSize,    FaultKind::kDuplicate, FaultKind::kReorder,
                                    FaultKind::kDrop, FaultKind::kForeign, FaultKind::kGarbage,   FaultKind::kLate,
                                    FaultKind::kZero, FaultKind::kHuge,    FaultKind::kCorrupt,   FaultKind::kClock};

constexpr bool HasAmount(FaultKind kind) noexcept { return kind == FaultKind::kLate || kind == FaultKind::kClock; }

[[noreturn]] void Reject(const std::string& item) {
  throw std::invalid_argument("\"" + item +
                              "\" is not a fault: expected nan@K, size@K, duplicate@K, reorder@K, drop@K, foreign@K, "
                              "garbage@K, zero@K, huge@K, corrupt@K, late@K:MS or clock@K:MS, with a pack number K >= "
                              "1 and milliseconds MS in (0, 60000]");
}

template <typename Number>
bool ParseAll(std::string_view text, Number* value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *value);
  return error == std::errc() && end == text.data() + text.size();
}

Fault ParseItem(const std::string& item) {
  const std::size_t at = item.find('@');
  if (at == std::string::npos) Reject(item);
  const std::string_view text(item);
  const std::string_view name = text.substr(0, at);
  std::string_view number = text.substr(at + 1);
  Fault fault;
  bool known = false;
  for (const FaultKind kind : kFaultKinds)
    if (name == ToString(kind)) {
      fault.kind = kind;
      known = true;
    }
  if (!known) Reject(item);
  const std::size_t colon = number.find(':');
  if ((colon != std::string_view::npos) != HasAmount(fault.kind)) Reject(item);
  if (HasAmount(fault.kind)) {
    if (!ParseAll(number.substr(colon + 1), &fault.amount_ms) ||
        !(fault.amount_ms > 0.0 && fault.amount_ms <= 60'000.0))
      Reject(item);
    number = number.substr(0, colon);
  }
  if (!ParseAll(number, &fault.pack) || fault.pack < 1) Reject(item);
  return fault;
}

}  // namespace

std::string_view ToString(FaultKind kind) noexcept {
  switch (kind) {
    case FaultKind::kNan: return "nan";
    case FaultKind::kSize: return "size";
    case FaultKind::kDuplicate: return "duplicate";
    case FaultKind::kReorder: return "reorder";
    case FaultKind::kDrop: return "drop";
    case FaultKind::kForeign: return "foreign";
    case FaultKind::kGarbage: return "garbage";
    case FaultKind::kLate: return "late";
    case FaultKind::kZero: return "zero";
    case FaultKind::kHuge: return "huge";
    case FaultKind::kCorrupt: return "corrupt";
    case FaultKind::kClock: return "clock";
  }
  return "unknown";
}

FaultPlan FaultPlan::Parse(const std::string& list) {
  FaultPlan plan;
  std::istringstream items(list);
  for (std::string item; std::getline(items, item, ',');) plan.faults_.push_back(ParseItem(item));
  if (plan.faults_.empty() || list.back() == ',') Reject("");
  return plan;
}

const Fault* FaultPlan::Find(FaultKind kind, std::int64_t pack) const noexcept {
  for (const Fault& fault : faults_)
    if (fault.kind == kind && fault.pack == pack) return &fault;
  return nullptr;
}

double FaultPlan::LateMs(std::int64_t pack) const noexcept {
  const Fault* fault = Find(FaultKind::kLate, pack);
  return fault != nullptr ? fault->amount_ms : 0.0;
}

double FaultPlan::ClockMs(std::int64_t pack) const noexcept {
  double ahead_ms = 0.0;
  for (const Fault& fault : faults_)
    if (fault.kind == FaultKind::kClock && fault.pack <= pack) ahead_ms += fault.amount_ms;
  return ahead_ms;
}

}  // namespace armcmc::plant_sim
