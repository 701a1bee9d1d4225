#include "armcmc/gap_watch/gap_watch.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/models/registry.hpp"
#include "armcmc/snapshot.hpp"

namespace armcmc {
namespace {

constexpr int kFirstChange = 3;    // an earlier one just shortens the block
constexpr int kPacksOfChange = 3;  // that the estimator may need to settle
constexpr double kLeastEvidence = 1e-12;
constexpr double kFade = 0.9;  // of the shares, from block to block

std::size_t At(int i) noexcept { return static_cast<std::size_t>(i); }

}  // namespace

GapWatch::GapWatch(const EstimatorSettings& settings, int model, const simd::Kernels& kernels)
    : settings_(settings.gap_watch),
      family_(FamilyOf(AllModels::kInfos[At(model)]->plant)),
      first_(settings, model, kernels),
      second_(settings, model, kernels),
      enabled_(settings.gap_watch.enabled && first_.num_columns() <= kGapColumns),
      block_(family_, std::min(first_.num_columns(), kGapColumns)),
      evidence_(family_.num_checks(), settings.gap_watch.false_alarm_rate) {
  if (enabled_)
    for (Recording& recording : recordings_) recording.packs.resize(kGapBlockPacks);
  state_.watched = enabled_;
}

void GapWatch::Save(SnapshotWriter* out) const noexcept {
  out->PutFlag(state_.suspected);
  out->Put(std::int64_t{state_.check});
  for (const std::int64_t v : {state_.since_seq, state_.alarm_seq, state_.num_blocks}) out->Put(v);
  for (const double v : {state_.log_evidence, state_.log_threshold, state_.share, excess_}) out->Put(v);
  out->PutRow(explained_.data(), explained_.size());
  for (const std::int64_t v : since_) out->Put(v);
  evidence_.Save(out);
}

void GapWatch::Restore(SnapshotReader* in) noexcept {
  constexpr std::int64_t kMostPacks = std::int64_t{1} << 62;
  state_.suspected = in->Flag();
  state_.check = static_cast<int>(in->Integer(-1, family_.num_checks() - 1));
  if (state_.check >= 0) state_.where = family_.check(state_.check);
  for (std::int64_t* v : {&state_.since_seq, &state_.alarm_seq, &state_.num_blocks}) *v = in->Integer(0, kMostPacks);
  for (double* v : {&state_.log_evidence, &state_.log_threshold, &state_.share, &excess_}) *v = in->Number();
  in->Row(explained_.data(), explained_.size());
  for (std::int64_t& v : since_) v = in->Integer(0, kMostPacks);
  evidence_.Restore(in);
}

void GapWatch::Reset() noexcept {
  for (Recording& recording : recordings_) recording.count = 0;
  analysed_ = nullptr;
  first_.Reset();
  second_.Reset();
  evidence_.Reset();
  memory_ = RegionMemory{};
  explained_ = {};
  excess_ = 0.0;
  since_ = {};
  last_number_ = -1;
  last_seq_ = last_run_ = 0;
  joining_ = false;
  state_ = GapState{};
  state_.watched = enabled_;
}

void GapWatch::Step(const DataPack& pack, const GapReference& estimate, bool changed) noexcept {
  if (!enabled_) return;
  const bool complete = Record(pack, changed);
  if (analysed_ != nullptr) Analyse(pack.num_samples);
  if (complete && recordings_[At(recording_)].count == kGapBlockPacks) BeginAnalysis(estimate);
}

void GapWatch::Analyse(int num_samples) noexcept {
  // In proportion to the estimator's own pack, of which one of the block may hold many.
  const int stretch = std::max(1, analysed_->packs.front().num_samples);
  const int pieces = std::clamp(kPiecesPerPack * num_samples / stretch, 1, kPiecesPerPack);
  for (int i = 0; i < pieces && analysed_ != nullptr; ++i) AnalysePiece();
}

void GapWatch::AnalysePiece() noexcept {
  constexpr int kFit = kGapBlockPacks, kSecondPass = kFit + 1, kScores = kSecondPass + kGapBlockPacks;
  const int piece = next_++;
  if (piece < kFit) {
    AnalysePack(piece, false);
  } else if (piece == kFit) {
    FitTrajectory();
  } else if (piece < kScores) {
    AnalysePack(piece - kSecondPass, true);
  } else if (piece == kScores) {
    block_.BeginScores();
  } else if (const int check = piece - kScores - 1; check < family_.num_checks()) {
    new_scores_[At(check)] = block_.Score(check, settings_.tolerance);
  } else {
    Judge();
    analysed_ = nullptr;
  }
}

bool GapWatch::Record(const DataPack& pack, bool changed) noexcept {
  Recording& block = recordings_[At(recording_)];
  const DataPack* last = joining_ ? &block.packs[At(block.count)] : nullptr;
  const bool follows = last_seq_ > 0 && pack.seq == last_seq_ + 1 && pack.run_id == last_run_;
  // A block knows one run of one plant, in order.
  if (pack.run_id != last_run_ || pack.seq <= last_seq_) block.count = 0;
  last_seq_ = pack.seq;
  last_run_ = pack.run_id;
  if (last != nullptr && (!follows || last->dt != pack.dt || last->num_samples + pack.num_samples > kMaxPackSamples))
    joining_ = false;  // the start that was kept is lost
  if (!follows) ++number_;
  if (block.count == 0 && !joining_) first_seq_ = pack.seq;

  DataPack& own = block.packs[At(block.count)];
  if (!joining_) {
    own = pack;
    own.seq = ++number_;
    block.changed[At(block.count)] = changed;
  } else {
    const auto at = static_cast<std::ptrdiff_t>(own.num_samples);
    std::copy_n(pack.y.begin(), pack.num_samples, own.y.begin() + at);
    std::copy_n(pack.u.begin(), pack.num_samples, own.u.begin() + at);
    own.num_samples += pack.num_samples;
    own.t_last_s = pack.t_last_s;
    block.changed[At(block.count)] = block.changed[At(block.count)] || changed;
  }
  const bool more_fit = own.num_samples + pack.num_samples <= kMaxPackSamples;
  joining_ = more_fit && own.num_samples * own.dt < kShortestPack * (1.0 - 1e-9);
  if (joining_) return false;
  ++block.count;
  return true;
}

void GapWatch::BeginAnalysis(const GapReference& estimate) noexcept {
  analysed_ = &recordings_[At(recording_)];
  recording_ = 1 - recording_;
  recordings_[At(recording_)].count = 0;
  analysed_seq_ = first_seq_;
  next_ = 0;
  reference_ = estimate;
  for (GapShift& shift : shift_) shift.fill(0.0);
  block_.Clear();
  PlaceChange();
}

void GapWatch::PlaceChange() noexcept {
  change_ = kNoChange;
  left_out_.fill(false);
  const auto& changed = analysed_->changed;
  for (int k = 0; k < kFirstChange; ++k)
    if (changed[At(k)]) std::fill_n(left_out_.begin(), k + 1, true);
  for (int k = kFirstChange; k < kGapBlockPacks && change_ == kNoChange; ++k) {
    if (!changed[At(k)]) continue;
    change_ = k;
    for (int i = k; i < std::min(k + kPacksOfChange, kGapBlockPacks) && changed[At(i)]; ++i) left_out_[At(i)] = true;
  }
}

void GapWatch::AnalysePack(int k, bool second_pass) noexcept {
  const DataPack& pack = analysed_->packs[At(k)];
  GapLineariser& lineariser = second_pass ? second_ : first_;
  const GapReference at = lineariser.Moved(reference_, shift_[At(k)]);
  const bool usable = lineariser.Linearise(pack, at, &rows_, &modes_);
  const double tau = 2.0 * k / (kGapBlockPacks - 1) - 1.0;
  const bool changed = k > change_;
  if (!second_pass) {
    if (usable && !left_out_[At(k)]) block_.AddFit(k, rows_, tau, changed);
    return;
  }
  family_.fill(pack, modes_, rows_.output.data(), &memory_, &regions_);
  for (int r = 0; r < family_.num_regions; ++r)
    for (std::size_t n = 0; n < At(pack.num_samples); ++n)
      if (!rows_.used[n]) regions_[At(r)][n] = 0.0;
  if (!usable || left_out_[At(k)]) {
    last_number_ = -1;
    return;
  }
  block_.AddRegions(k, rows_, tau, changed, regions_, pack.seq == last_number_ + 1);
  last_number_ = pack.seq;
}

void GapWatch::FitTrajectory() noexcept {
  std::array<double, kGapColumns> precision{};
  for (int c = 0; c < first_.num_columns(); ++c) {
    const ParameterSettings& p = first_.parameter(c);
    const double sd = p.prior == PriorKind::kNormal ? p.sd : p.upper - p.lower;
    precision[At(c)] = 1.0 / (sd * sd);
  }
  block_.Fit(precision, &shift_);
  block_.Clear();
  last_number_ = -1;
}

void GapWatch::Judge() noexcept {
  scores_ = new_scores_;
  const DataPack& first = analysed_->packs.front();
  const DataPack& last = analysed_->packs.back();
  const double even = evidence_.stakes() / family_.num_checks();
  for (int c = 0; c < family_.num_checks(); ++c)
    if (since_[At(c)] == 0 || evidence_.of(c) <= even) since_[At(c)] = analysed_seq_;
  evidence_.Add(scores_, (last.t_last_s - first.t_last_s + first.num_samples * first.dt) / 3600.0);

  int best = 0;
  excess_ = kFade * excess_ + std::max(block_.excess(), 0.0);
  for (int c = 0; c < family_.num_checks(); ++c) {
    explained_[At(c)] = kFade * explained_[At(c)] + block_.explained(c);
    if (evidence_.of(c) > evidence_.of(best)) best = c;
  }
  state_.num_blocks += 1;
  state_.check = best;
  state_.where = family_.check(best);
  state_.log_evidence = std::log(std::max(evidence_.total() / evidence_.stakes(), kLeastEvidence));
  state_.log_threshold = -std::log(evidence_.stakes());
  const double all = std::max(excess_, explained_[At(best)]);
  state_.share = all > 0.0 ? explained_[At(best)] / all : 0.0;
  if (!state_.suspected && evidence_.total() >= 1.0) {
    state_.suspected = true;
    state_.alarm_seq = last_seq_;
  }
  state_.since_seq = since_[At(best)];
}

}  // namespace armcmc
