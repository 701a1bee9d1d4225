#include "armcmc/gap_watch/gap_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "armcmc/models/registry.hpp"
#include "gap_tools.hpp"

namespace armcmc {
namespace {

constexpr int kFirstChange = 3;       // an earlier change only shortens the block
constexpr double kGapDamping = 1e-4;  // of the fit of trajectories: valleys in their parameters are curved
constexpr int kPacksOfChange = 3;     // in which the estimator settles

bool HasStates(const EstimatorSettings& settings) {
  return settings.plant != nullptr && settings.plant->states().size() > 0;
}

std::vector<std::unique_ptr<GapLineariser>> MakeLinearisers(const EstimatorSettings& settings, int model,
                                                            const simd::Kernels& kernels, bool judges_passive,
                                                            int count) {
  std::vector<std::unique_ptr<GapLineariser>> passes(At(count));
  for (auto& pass : passes) pass = std::make_unique<GapLineariser>(settings, model, kernels, judges_passive);
  return passes;
}

bool CanWatch(int num_columns) { return num_columns <= kGapColumns; }

}  // namespace

GapWatch::GapWatch(const EstimatorSettings& settings, int model, const simd::Kernels& kernels, double rate)
    : settings_(settings.gap_watch),
      probes_(HasStates(settings)
                  ? std::make_unique<StateProbes>(*settings.plant, kernels, DescribedFamily::kMostProbes)
                  : nullptr),
      described_(settings.plant != nullptr
                     ? std::make_unique<const DescribedFamily>(*settings.plant,
                                                               probes_ ? probes_->names() : std::vector<std::string>{})
                     : nullptr),
      family_(described_ != nullptr ? static_cast<const GapFamily&>(*described_)
                                    : CompiledModels()[At(model)]->compiled->gap_family()),
      passes_(MakeLinearisers(settings, model, kernels, family_.judges_passive(), probes_ ? kMostPasses : 2)),
      enabled_(settings.gap_watch.enabled && CanWatch(passes_[0]->num_columns())),
      most_samples_(probes_ ? probes_->most_samples() : kMaxPackSamples),
      shortest_s_(probes_ ? std::numeric_limits<double>::infinity() : kShortestPack),
      block_(family_.checks(), std::min(passes_[0]->num_columns(), kGapColumns)),
      judge_(family_.checks(), rate) {
  if (enabled_)
    for (Recording& recording : recordings_) recording.packs.resize(kGapBlockPacks);
  judge_.Reset(enabled_);
}

std::string_view GapWatch::CheckName(int check) const noexcept {
  return check >= 0 && check < family_.checks().size() ? family_.checks().name(check) : "";
}

void GapWatch::Reset() noexcept {
  for (Recording& recording : recordings_) recording.count = 0;
  analysed_ = nullptr;
  for (const auto& pass : passes_) pass->Reset();
  if (probes_) probes_->Reset();
  judge_.Reset(enabled_);
  memory_ = RegionMemory{};
  last_number_ = -1;
  last_seq_ = last_run_ = 0;
  joining_ = false;
}

void GapWatch::Step(const DataPack& pack, const GapReference& estimate, bool changed, bool drifts) noexcept {
  if (!enabled_) return;
  const bool complete = Record(pack, changed, drifts);
  if (analysed_ != nullptr) Analyse(pack.num_samples);
  if (complete && recordings_[At(recording_)].count == kGapBlockPacks) BeginAnalysis(estimate);
}

void GapWatch::Analyse(int num_samples) noexcept {
  // In proportion to the estimator's own pack; a pack of the block may contain many of them.
  const int stretch = std::max(1, analysed_->packs.front().num_samples);
  const int rounded_up = probes_ ? stretch - 1 : 0;  // there are more pieces
  const int pieces = std::clamp((kPiecesPerPack * num_samples + rounded_up) / stretch, 1, kPiecesPerPack);
  for (int i = 0; i < pieces && analysed_ != nullptr; ++i) AnalysePiece();
}

void GapWatch::AnalysePiece() noexcept {
  const int last_pass = static_cast<int>(passes_.size()) - 1;
  const int piece = next_++;
  const int pass = std::min(piece / (kGapBlockPacks + 1), last_pass);
  const int k = piece - pass * (kGapBlockPacks + 1);
  if (k < kGapBlockPacks) {
    AnalysePack(k, pass);
  } else if (pass < last_pass) {
    FitTrajectory();
  } else if (k == kGapBlockPacks) {
    block_.BeginScores();
  } else if (const int check = k - kGapBlockPacks - 1; check < family_.checks().size()) {
    new_scores_[At(check)] = block_.Score(check, settings_.tolerance);
  } else {
    Judge();
    analysed_ = nullptr;
  }
}

bool GapWatch::Record(const DataPack& pack, bool changed, bool drifts) noexcept {
  Recording& block = recordings_[At(recording_)];
  const DataPack* last = joining_ ? &block.packs[At(block.count)] : nullptr;
  const bool follows = last_seq_ > 0 && pack.seq == last_seq_ + pack.seq_step && pack.run_id == last_run_;
  // A block covers one run of one plant, in order.
  if (pack.run_id != last_run_ || pack.seq <= last_seq_) block.count = 0;
  last_seq_ = pack.seq;
  last_run_ = pack.run_id;
  if (last != nullptr && (!follows || last->dt != pack.dt || last->num_samples + pack.num_samples > most_samples_))
    joining_ = false;  // the stored start is lost
  if (!follows) ++number_;
  if (block.count == 0 && !joining_) {
    first_seq_ = pack.seq;
    block.drifts = false;
  }
  block.drifts = block.drifts || drifts;

  DataPack& own = block.packs[At(block.count)];
  if (!joining_) {
    own = pack;
    own.seq = ++number_;
    own.seq_step = 1;
    block.changed[At(block.count)] = changed;
  } else {
    const auto at = static_cast<std::ptrdiff_t>(own.num_samples);
    std::copy_n(pack.y.begin(), pack.num_samples, own.y.begin() + at);
    std::copy_n(pack.u.begin(), pack.num_samples, own.u.begin() + at);
    own.num_samples += pack.num_samples;
    own.t_last_s = pack.t_last_s;
    block.changed[At(block.count)] = block.changed[At(block.count)] || changed;
  }
  const bool more_fit = own.num_samples + pack.num_samples <= most_samples_;
  joining_ = more_fit && own.num_samples * own.dt < shortest_s_ * (1.0 - 1e-9);
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
  block_.Clear(analysed_->drifts);
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

void GapWatch::AnalysePack(int k, int pass) noexcept {
  const DataPack& pack = analysed_->packs[At(k)];
  GapLineariser& lineariser = *passes_[At(pass)];
  const GapReference at = lineariser.Moved(reference_, shift_[At(k)]);
  const bool usable = lineariser.Linearise(pack, at, &rows_, &modes_);
  const double tau = 2.0 * k / (kGapBlockPacks - 1) - 1.0;
  const bool changed = k > change_;
  if (At(pass) + 1 < passes_.size()) {
    if (usable && !left_out_[At(k)]) block_.AddFit(k, rows_, tau, changed);
    return;
  }
  family_.Fill(pack, modes_, rows_.output.data(), &memory_, &regions_);
  if (probes_ && usable && probes_->size() > 0)
    probes_->Fill(pack, at.theta[0], lineariser.start(), at.noise_std[0], described_->first_probe(), &regions_);
  for (int r = 0; r < family_.checks().num_regions; ++r)
    for (std::size_t n = 0; n < At(pack.num_samples); ++n)
      if (!rows_.used[n]) regions_[At(r)][n] = 0.0;
  for (int r = 0; r < family_.checks().num_regions; ++r) lineariser.RemoveStarts(&regions_[At(r)]);
  if (!usable || left_out_[At(k)]) {
    last_number_ = -1;
    return;
  }
  block_.AddRegions(k, rows_, tau, changed, regions_, pack.seq == last_number_ + 1);
  last_number_ = pack.seq;
}

void GapWatch::FitTrajectory() noexcept {
  std::array<double, kGapColumns> precision{};
  for (int c = 0; c < passes_[0]->num_columns(); ++c) {
    const ParameterSettings& p = passes_[0]->parameter(c);
    const double sd = p.prior == PriorKind::kNormal ? p.sd : p.upper - p.lower;
    precision[At(c)] = 1.0 / (sd * sd);
  }
  std::array<GapShift, kGapBlockPacks> further;
  block_.Fit(precision, probes_ ? kGapDamping : 0.0, &further);
  for (int k = 0; k < kGapBlockPacks; ++k)
    for (std::size_t c = 0; c < kGapColumns; ++c) shift_[At(k)][c] += further[At(k)][c];
  block_.Clear(analysed_->drifts);
  last_number_ = -1;
}

void GapWatch::Judge() noexcept {
  scores_ = new_scores_;
  const DataPack& first = analysed_->packs.front();
  const DataPack& last = analysed_->packs.back();
  const double seconds = last.t_last_s - first.t_last_s + first.num_samples * first.dt;
  judge_.Add(scores_, block_, {analysed_seq_, last_seq_, seconds / 3600.0});
}

}  // namespace armcmc
