#include "armcmc/gap_watch/gap_judge.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/snapshot.hpp"
#include "gap_tools.hpp"

namespace armcmc {
namespace {

constexpr double kLeastEvidence = 1e-12;
constexpr double kFade = 0.9;  // of the shares, from block to block

}  // namespace

void GapJudge::Save(SnapshotWriter* out) const noexcept {
  out->PutFlag(state_.suspected);
  out->Put(std::int64_t{state_.check < 0 ? -1 : state_.check - checks_.first});
  for (const std::int64_t v : {state_.since_seq, state_.alarm_seq, state_.num_blocks}) out->Put(v);
  for (const double v : {state_.log_evidence, state_.log_threshold, state_.share, excess_}) out->Put(v);
  out->PutRow(explained_.data(), explained_.size());
  for (const std::int64_t v : since_) out->Put(v);
  evidence_.Save(out);
}

void GapJudge::Restore(SnapshotReader* in) noexcept {
  constexpr std::int64_t kMostPacks = std::int64_t{1} << 62;
  state_.suspected = in->Flag();
  const int check = static_cast<int>(in->Integer(-1, checks_.size() - 1));
  state_.check = check < 0 ? -1 : checks_.first + check;
  if (check >= 0) state_.where = checks_.name(check);
  for (std::int64_t* v : {&state_.since_seq, &state_.alarm_seq, &state_.num_blocks}) *v = in->Integer(0, kMostPacks);
  for (double* v : {&state_.log_evidence, &state_.log_threshold, &state_.share, &excess_}) *v = in->Number();
  in->Row(explained_.data(), explained_.size());
  for (std::int64_t& v : since_) v = in->Integer(0, kMostPacks);
  evidence_.Restore(in);
}

void GapJudge::Reset(bool watched) noexcept {
  evidence_.Reset();
  explained_ = {};
  excess_ = 0.0;
  since_ = {};
  state_ = GapState{};
  state_.watched = watched;
}

void GapJudge::Add(const std::array<CheckScore, kMaxGapChecks>& scores, const GapBlock& block,
                   const GapBlockSpan& span) noexcept {
  const double even = evidence_.stakes() / checks_.size();
  for (int c = 0; c < checks_.size(); ++c)
    if (since_[At(c)] == 0 || evidence_.of(c) <= even) since_[At(c)] = span.first_seq;
  evidence_.Add(scores, span.hours);

  int best = 0;
  excess_ = kFade * excess_ + std::max(block.excess(), 0.0);
  for (int c = 0; c < checks_.size(); ++c) {
    explained_[At(c)] = kFade * explained_[At(c)] + block.explained(c);
    if (evidence_.of(c) > evidence_.of(best)) best = c;
  }
  state_.num_blocks += 1;
  state_.check = checks_.first + best;
  state_.where = checks_.name(best);
  state_.log_evidence = std::log(std::max(evidence_.total() / evidence_.stakes(), kLeastEvidence));
  state_.log_threshold = -std::log(evidence_.stakes());
  const double all = std::max(excess_, explained_[At(best)]);
  state_.share = all > 0.0 ? explained_[At(best)] / all : 0.0;
  if (!state_.suspected && evidence_.total() >= 1.0) {
    state_.suspected = true;
    state_.alarm_seq = span.now_seq;
  }
  state_.since_seq = since_[At(best)];
}

}  // namespace armcmc
