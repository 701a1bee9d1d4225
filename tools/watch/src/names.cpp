#include "armcmc/watch/names.hpp"

#include <array>
#include <limits>
#include <utility>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/models/registry.hpp"

namespace armcmc::watch {
namespace {

using Flag = std::pair<int, const char*>;

template <std::size_t kSize>
std::vector<std::string> Words(int flags, const std::array<Flag, kSize>& known) {
  std::vector<std::string> words;
  for (const auto& [flag, word] : known) {
    if ((flags & flag) != 0) words.emplace_back(word);
    flags &= ~flag;
  }
  if (flags != 0) words.push_back("unknown flag " + std::to_string(flags));
  return words;
}

}  // namespace

std::string ModeName(int plant_kind, int mode) {
  const ModelInfo* info = ModelOf(PlantNumber{plant_kind});
  if (info != nullptr && mode >= 0 && mode <= info->num_modes)
    return std::string(info->modes[static_cast<std::size_t>(mode)]);
  return "mode " + std::to_string(mode);
}

std::string DecisionName(int decision) {
  switch (decision) {
    case estimate_t::DECISION_HOLD: return "hold";
    case estimate_t::DECISION_REINFORCEMENT: return "reinforcement";
    case estimate_t::DECISION_MODIFICATION: return "modification";
    default: return "decision " + std::to_string(decision);
  }
}

std::vector<std::string> DegradedWords(int flags) {
  using S = estimator_status_t;
  return Words<7>(flags, {{{S::DEGRADED_NO_FIFO, "no real-time scheduling (SCHED_FIFO)"},
                           {S::DEGRADED_NO_AFFINITY, "threads not pinned to CPUs"},
                           {S::DEGRADED_NO_MLOCK, "memory not locked"},
                           {S::DEGRADED_SHARED_CPU, "stages share one CPU"},
                           {S::DEGRADED_NO_WITNESS, "no witness"},
                           {S::DEGRADED_INJECTED, "injected faults"},
                           {S::DEGRADED_CPUS_SLEEP, "CPUs sleep when idle"}}});
}

std::vector<std::string> FaultWords(int flags) {
  using S = estimator_status_t;
  return Words<11>(flags, {{{S::FAULT_PLANT_SILENT, "plant is silent"},
                            {S::FAULT_PLANT_RESTARTED, "plant was restarted"},
                            {S::FAULT_BAD_DATA, "bad data"},
                            {S::FAULT_TRUNCATED, "draws cut by the deadline"},
                            {S::FAULT_PUBLISH, "publishing failed"},
                            {S::FAULT_BACKLOG, "backlog dropped"},
                            {S::FAULT_NUMERIC, "numeric trouble"},
                            {S::FAULT_CLOCK_JUMP, "the plant's clock jumped"},
                            {S::FAULT_BUS_FLOOD, "bus flooded"},
                            {S::FAULT_STAGE_HUNG, "a stage hangs"},
                            {S::FAULT_SNAPSHOT, "snapshot not written"}}});
}

std::string FieldText(const std::uint8_t* field, int size) {
  std::string text;
  for (int i = 0; i < size && field[i] != 0; ++i) {
    text += field[i] >= 0x20 && field[i] < 0x7f ? static_cast<char>(field[i]) : '?';
  }
  return text;
}

std::string PerSecond(const std::string& unit) { return unit.empty() || unit == "-" ? "per s" : unit + " per s"; }

double TrueValue(const plant_truth_t& truth, const estimate_t& estimate, int parameter) noexcept {
  // Where there are several modes, the parameters belong to the one that acts.
  const ModelInfo* info = ModelOf(PlantNumber{truth.plant_kind});
  const bool same =
      (info != nullptr && info->num_modes == 1) || (truth.true_mode == estimate.mode && estimate.in_contact != 0);
  if (!same || truth.plant_kind != estimate.plant_kind || parameter < 0 || parameter >= truth.n_params ||
      parameter >= plant_truth_t::MAX_PARAMS) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return truth.theta_true[parameter];
}

std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace armcmc::watch
