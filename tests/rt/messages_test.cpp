#include "armcmc/rt/messages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fake_engine.hpp"
#include "plants/hunt_crossley/effects.hpp"
#include "plants/soft_actuator/effects.hpp"

namespace armcmc::rt::messages_test {
namespace {

std::unique_ptr<StepOutput> Output(test::FakeEngine* engine) {
  auto output = std::make_unique<StepOutput>();
  DataPack pack;
  pack.seq = 7;
  pack.run_id = 3;
  pack.num_samples = 1;
  pack.y[0] = 2.5;
  (void)engine->Adjust(pack, 0, ClockRef{}, 0);
  engine->Execute(0, &output->estimate);
  output->info.seq = 7;
  output->info.run_id = 3;
  output->info.status = Status::kTruncated;
  output->info.times.release_ns = 1000;
  output->info.times.deadline_ns = 2000;
  output->info.times.start_ns = {1100, 1200, 1300};
  output->info.times.end_ns = {1110, 1220, 1330};
  return output;
}

template <std::size_t kSize>
std::string Text(const std::uint8_t (&field)[kSize]) {
  return {field, std::find(field, field + kSize, std::uint8_t{0})};
}

TEST(FillEstimate, ReportsTheActingModeWithNamesAndTimes) {
  test::FakeEngine engine;
  const auto output = Output(&engine);
  MarginalSummary& marginal = output->estimate.modes[0].marginal[1];
  marginal.ar_map = 1.0;
  marginal.ar_ap = 2.0;
  marginal.sd = 3.0;
  marginal.q025 = 4.0;
  marginal.q25 = 5.0;
  marginal.q50 = 6.0;
  marginal.q75 = 7.0;
  marginal.q975 = 8.0;
  estimate_t message;
  std::memset(static_cast<void*>(&message), 0xff, sizeof message);  // every field must be written
  FillEstimate(*output, engine, 99, &message);
  EXPECT_EQ(message.utime, 99);
  EXPECT_EQ(message.seq, 7);
  EXPECT_EQ(message.run_id, 3);
  EXPECT_EQ(message.t_release_ns, 1000);
  EXPECT_EQ(message.t_done_ns, 1330);
  EXPECT_EQ(message.plant_kind, data_pack_t::PLANT_HUNT_CROSSLEY);
  EXPECT_EQ(message.known, 1);
  EXPECT_EQ(message.in_contact, 1);
  EXPECT_EQ(message.truncated, 1);
  EXPECT_EQ(message.decision, estimate_t::DECISION_REINFORCEMENT);
  EXPECT_EQ(message.n_params, 2);
  EXPECT_EQ(message.n_modes, 1);
  EXPECT_EQ(Text(message.param_name[0]), "K");
  EXPECT_EQ(Text(message.param_unit[0]), "N/m^p");
  EXPECT_EQ(Text(message.param_name[1]), "a_name_of_more_") << "cut, and still zero terminated";
  EXPECT_EQ(message.ar_map[0], 7.0);
  EXPECT_EQ(message.ar_map_by_mode[0][0], 7.0);
  EXPECT_EQ(message.known_by_mode[0], 1);
  EXPECT_EQ(message.known_by_mode[1], 0);
  EXPECT_EQ(message.ar_map[2], 0.0);
  EXPECT_EQ(message.ar_map[1], 1.0);
  EXPECT_EQ(message.ar_ap[1], 2.0);
  EXPECT_EQ(message.sd[1], 3.0);
  EXPECT_EQ(message.q025[1], 4.0);
  EXPECT_EQ(message.q25[1], 5.0);
  EXPECT_EQ(message.q50[1], 6.0);
  EXPECT_EQ(message.q75[1], 7.0);
  EXPECT_EQ(message.q975[1], 8.0);
  EXPECT_EQ(message.sd_by_mode[0][1], 3.0);
  EXPECT_EQ(message.draws, 1000);
  EXPECT_EQ(message.y_pred, 2.5);
}

/// Reports parameters of the names that it is given.
class Naming final : public test::FakeEngine {
 public:
  explicit Naming(std::vector<std::string> names) : names_(std::move(names)) {}
  [[nodiscard]] int num_reported() const noexcept ARMCMC_NONBLOCKING override {
    return static_cast<int>(names_.size());
  }
  [[nodiscard]] ReportedQuantity reported(int index) const noexcept ARMCMC_NONBLOCKING override {
    return {names_[static_cast<std::size_t>(index)], "-"};
  }

 private:
  std::vector<std::string> names_;
};

/// Every two parameters of effects in one message.
template <class Effects>
void ExpectNamesApart() {
  std::vector<std::string> names;
  for (const EffectInfo* effect : Effects::kInfos)
    for (int a = 0; a < effect->num_amplitudes; ++a)
      names.push_back(std::string(effect->name) + "_" +
                      std::string(effect->amplitudes[static_cast<std::size_t>(a)].name));
  EXPECT_GT(names.size(), 4u);
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      Naming engine({names[i], names[j]});
      estimate_t message;
      FillEstimate(*Output(&engine), engine, 1, &message);
      EXPECT_NE(Text(message.param_name[0]), Text(message.param_name[1])) << names[i] << " " << names[j];
    }
}

TEST(FillEstimate, TellsTheParametersOfAllEffectsApart) {
  ExpectNamesApart<ContactEffects>();
  ExpectNamesApart<FlowEffects>();
}

TEST(FillEstimate, SaysNothingOfParametersBeforeAnythingIsKnown) {
  test::FakeEngine engine;
  auto output = Output(&engine);
  output->estimate.modes[0].known = output->estimate.modes[0].updated = false;
  estimate_t message;
  FillEstimate(*output, engine, 0, &message);
  EXPECT_EQ(message.known, 0);
  EXPECT_EQ(message.ar_map[0], 0.0);
  EXPECT_EQ(message.decision, estimate_t::DECISION_HOLD);
}

TEST(FillPosterior, CopiesTheMarginalsOfTheReportedMode) {
  test::FakeEngine engine;
  posterior_t message;
  std::memset(static_cast<void*>(&message), 0xff, sizeof message);
  FillPosterior(*Output(&engine), engine, 5, &message);
  EXPECT_EQ(message.seq, 7);
  EXPECT_EQ(message.known, 1);
  EXPECT_EQ(message.n_params, 2);
  EXPECT_EQ(message.n_bins, posterior_t::MAX_BINS);
  EXPECT_EQ(message.hi[0], 1.0);
  EXPECT_EQ(message.density[0][63], 1.0);
  EXPECT_EQ(message.density[2][0], 0.0);
}

TEST(FillChange, SaysWhatIsBelievedWithNamesAndUnits) {
  test::FakeEngine engine;
  const auto output = Output(&engine);
  ModeEstimate& mode = output->estimate.modes[0];
  mode.p_drifted = 0.625;
  mode.p_changed = 0.125;
  mode.drift_rate[0] = 0.5;
  mode.drift_rate[1] = 0.0625;
  mode.drift_rate[2] = 7.0;  // of no parameter
  change_t message;
  std::memset(static_cast<void*>(&message), 0xff, sizeof message);
  FillChange(*output, engine, 5, &message);
  EXPECT_EQ(message.change_utime, 5);
  EXPECT_EQ(message.seq, 7);
  EXPECT_EQ(message.run_id, 3);
  EXPECT_EQ(message.plant_kind, data_pack_t::PLANT_HUNT_CROSSLEY);
  EXPECT_EQ(message.mode, 0);
  EXPECT_EQ(message.n_modes, 1);
  EXPECT_EQ(message.n_params, 2);
  EXPECT_EQ(Text(message.mode_name[0]), "contact");
  EXPECT_EQ(Text(message.mode_name[1]), "");
  EXPECT_EQ(Text(message.param_name[0]), "K");
  EXPECT_EQ(Text(message.param_unit[0]), "N/m^p");
  EXPECT_EQ(Text(message.param_name[1]), "a_name_of_more_");
  EXPECT_EQ(message.known[0], 1);
  EXPECT_EQ(message.known[1], 0);
  EXPECT_EQ(message.updated[0], 1);
  EXPECT_EQ(message.p_persisted[0], 0.25);
  EXPECT_EQ(message.p_drifted[0], 0.625);
  EXPECT_EQ(message.p_changed[0], 0.125);
  EXPECT_EQ(message.drift_rate[0][0], 0.5);
  EXPECT_EQ(message.drift_rate[0][1], 0.0625);
  EXPECT_EQ(message.drift_rate[0][2], 0.0);
  EXPECT_EQ(message.p_persisted[1], 0.0);
  mode.known = false;
  FillChange(*output, engine, 5, &message);
  EXPECT_EQ(message.known[0], 0);
  EXPECT_EQ(message.p_persisted[0], 0.0);
  EXPECT_EQ(message.drift_rate[0][0], 0.0);
}

TEST(FillStatus, CarriesTimesCountersAndFlags) {
  test::FakeEngine engine;
  const auto output = Output(&engine);
  const auto counters = std::make_unique<Counters>();
  counters->collect.received.Set(11);
  counters->collect.rejected[static_cast<std::size_t>(RejectCause::kNotFinite)].Set(2);
  counters->collect.rejected[static_cast<std::size_t>(RejectCause::kLength)].Set(3);
  counters->collect.rejected[static_cast<std::size_t>(RejectCause::kFingerprint)].Set(4);
  counters->adjust.dropped.Set(5);
  counters->collect.ring_full.Set(1);
  const RtSettings settings;
  const auto monitor = std::make_unique<DeadlineMonitor>(settings);
  StatusContext context;
  context.output = output.get();
  context.fault_flags = estimator_status_t::FAULT_BAD_DATA;
  context.degraded_flags = estimator_status_t::DEGRADED_NO_FIFO;
  context.gap = {true, true, 3, {}, 9.5, 5.25, 0.75, 21, 160, 4};
  context.gap.where = "free_direction";
  estimator_status_t message;
  std::memset(static_cast<void*>(&message), 0xff, sizeof message);
  FillStatus(context, settings, *counters, *monitor, &message);
  EXPECT_EQ(message.collect_ns, 10);
  EXPECT_EQ(message.adjust_ns, 20);
  EXPECT_EQ(message.execute_ns, 30);
  EXPECT_EQ(message.end_to_end_ns, 330);
  EXPECT_EQ(message.slack_ns, 670);
  EXPECT_EQ(message.packs_received, 11);
  EXPECT_EQ(message.packs_rejected, 9);
  EXPECT_EQ(message.rejected_value, 2);
  EXPECT_EQ(message.rejected_size, 3);
  EXPECT_EQ(message.rejected_type, 4);
  EXPECT_EQ(message.packs_dropped, 6);
  EXPECT_EQ(message.fault_flags, estimator_status_t::FAULT_BAD_DATA);
  EXPECT_EQ(message.degraded_flags, estimator_status_t::DEGRADED_NO_FIFO);
  EXPECT_EQ(message.missed_own, 0);
  EXPECT_EQ(message.gap_watched, 1);
  EXPECT_EQ(message.gap_suspected, 1);
  EXPECT_EQ(message.gap_check, 3);
  EXPECT_EQ(Text(message.gap_where), "free_direction");
  EXPECT_EQ(message.gap_log_evidence, 9.5);
  EXPECT_EQ(message.gap_log_threshold, 5.25);
  EXPECT_EQ(message.gap_share, 0.75);
  EXPECT_EQ(message.gap_since_seq, 21);
  EXPECT_EQ(message.gap_alarm_seq, 160);
}

}  // namespace
}  // namespace armcmc::rt::messages_test
