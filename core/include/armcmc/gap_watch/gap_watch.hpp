#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/gap_watch/described_family.hpp"
#include "armcmc/gap_watch/gap_block.hpp"
#include "armcmc/gap_watch/gap_checks.hpp"
#include "armcmc/gap_watch/gap_judge.hpp"
#include "armcmc/gap_watch/gap_rows.hpp"
#include "armcmc/gap_watch/gap_settings.hpp"
#include "armcmc/gap_watch/gap_state.hpp"
#include "armcmc/gap_watch/state_probes.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/settings.hpp"

namespace armcmc {

/// Watches for a persistent gap between a model and its plant, while the estimator runs.
///
/// Errors are examined in blocks of kGapBlockPacks packs (shorter ones than kShortestPack are joined). A block is
/// recorded, then, while the next one is recorded, linearised twice: at the estimate, and along the trajectory of
/// parameters that fits the block best (constant, plus even drift, plus one step where the estimator saw a change; plus
/// a drift whose speed changes where the estimator found drift probable).
/// What no such trajectory explains is scored by region (GapBlock) and turned into anytime-valid evidence
/// (GapEvidence).
///
/// So a parameter that drifts or steps occasionally is not a gap, whether or not the estimator has followed it yet.
/// Effects that a drifting parameter imitates (stiffness drift itself) are not seen, by construction. The rate of false
/// alarms holds for noise of any law that is symmetric, of any scale, coloured over less than a pack; it does not need
/// the noise level to be known.
///
/// The estimates decide only where to linearise, so the number of draws hardly matters here.
///
/// Of a described plant whose law needs states, each pack is a trajectory of its own: where it starts is fitted to the
/// pack, and what a start can explain is projected out of errors, sensitivities and regions (GapStarts). Regions are
/// the responses to terms that the rates lack (StateProbes). So that trajectories are long, packs are joined while
/// there is room. Since they are nonlinear in the parameters, the block is linearised four times instead of twice, and
/// scored only where the last fit hardly changes it: a block that is not gives no evidence for or against a gap, as a
/// pack does whose start has not been found. Not detected either: an effect that changes the output of a trajectory
/// of a few hundred samples less than the start and the parameters do. Packs should therefore be as long as the
/// response time of the plant. The inputs count as exact, as they do in every law: noise on an input that rings on in a
/// resonance, and is larger there than that of the output, looks like a missing friction.
///
/// Not watched: plants with more than kGapColumns parameters in all modes together.
class GapWatch {
 public:
  /// Allocates. @param settings  Valid; outlives the watch. @param rate  Of false alarms, see GapEvidence.
  GapWatch(const EstimatorSettings& settings, int model, const simd::Kernels& kernels, double rate);

  /// One pack, in the order of the estimator. @param changed  The estimator made a modification at this pack.
  /// @param drifts  It considers drift probable.
  /// @pre pack.Validate() == kOk, and the pack is of the model's plant.
  /// @rt No heap, no lock, no throw. O(samples).
  void Step(const DataPack& pack, const GapReference& estimate, bool changed,
            bool drifts = false) noexcept ARMCMC_NONBLOCKING;
  void Reset() noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] const GapState& state() const noexcept { return judge_.state(); }
  [[nodiscard]] bool enabled() const noexcept { return enabled_; }
  /// Name of a check by its index in GapState; empty for none.
  [[nodiscard]] std::string_view CheckName(int check) const noexcept;
  /// The evidence of the blocks that were judged, and the alarm. The block under way is not kept.
  void Save(SnapshotWriter* out) const noexcept ARMCMC_NONBLOCKING { judge_.Save(out); }
  void Restore(SnapshotReader* in) noexcept ARMCMC_NONBLOCKING { judge_.Restore(in); }
  /// Of the last block.
  [[nodiscard]] const std::array<CheckScore, kMaxGapChecks>& scores() const noexcept { return scores_; }

 private:
  /// Pieces of the analysis of one block per pack of the next one: a pack of one pass, the fit, a score. All pieces
  /// are done well before the next block is full.
  static constexpr int kPiecesPerPack = 6;
  static constexpr int kMostPasses = 4;
  static_assert(kPiecesPerPack * kGapBlockPacks > 2 * (2 * kGapBlockPacks + kMaxGapChecks + 3));
  static_assert(kPiecesPerPack * kGapBlockPacks > kMostPasses * (kGapBlockPacks + 1) + kMaxGapChecks + 2);
  static constexpr double kShortestPack = 0.1;  ///< s: longer than the correlation time of coloured noise.
  static constexpr int kNoChange = kGapBlockPacks;

  struct Recording {
    std::vector<DataPack> packs;
    std::array<bool, kGapBlockPacks> changed{};
    int count = 0;        ///< Complete ones.
    bool drifts = false;  ///< Probable at some pack.
  };

  /// @return true when a pack of the block is complete.
  [[nodiscard]] bool Record(const DataPack& pack, bool changed, bool drifts) noexcept ARMCMC_NONBLOCKING;
  void Analyse(int num_samples) noexcept ARMCMC_NONBLOCKING;
  void AnalysePiece() noexcept ARMCMC_NONBLOCKING;
  void BeginAnalysis(const GapReference& estimate) noexcept ARMCMC_NONBLOCKING;
  /// The first change of the block, and which packs around it are left out.
  void PlaceChange() noexcept ARMCMC_NONBLOCKING;
  /// @param pass  The last one is that which is scored.
  void AnalysePack(int k, int pass) noexcept ARMCMC_NONBLOCKING;
  void FitTrajectory() noexcept ARMCMC_NONBLOCKING;
  void Judge() noexcept ARMCMC_NONBLOCKING;

  const GapWatchSettings& settings_;
  std::unique_ptr<StateProbes> probes_;               ///< Null: the law has no states.
  std::unique_ptr<const DescribedFamily> described_;  ///< Null: built in.
  const GapFamily& family_;
  /// One for each pass: each sees every pack once, in order. A trajectory is less linear in its parameters than a law,
  /// and is fitted more often.
  std::vector<std::unique_ptr<GapLineariser>> passes_;
  bool enabled_;
  int most_samples_;   ///< Of a pack of a block.
  double shortest_s_;  ///< Below which packs are joined while there is room.
  GapBlock block_;
  GapJudge judge_;
  std::array<CheckScore, kMaxGapChecks> scores_{}, new_scores_{};

  std::array<Recording, 2> recordings_;
  int recording_ = 0;
  bool joining_ = false;                      ///< packs[count] holds the start of a pack.
  std::int64_t last_seq_ = 0, last_run_ = 0;  ///< Of the estimator's packs.
  std::int64_t number_ = 0;                   ///< Of the block's packs; a loss leaves out one.
  std::int64_t first_seq_ = 0;                ///< Of the recorded block.
  std::int64_t analysed_seq_ = 0;             ///< First pack of the analysed block.
  Recording* analysed_ = nullptr;
  int next_ = 0;  ///< Pieces done.
  GapReference reference_;
  std::array<GapShift, kGapBlockPacks> shift_{};
  int change_ = kNoChange;
  std::array<bool, kGapBlockPacks> left_out_{};

  GapRows rows_;
  std::array<int, kMaxPackSamples> modes_{};
  RegionTemplates regions_{};
  RegionMemory memory_;
  std::int64_t last_number_ = -1;  ///< Of the packs that were scored.
};

}  // namespace armcmc
