#include "armcmc/gap_watch/gap_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "armcmc/snapshot.hpp"

namespace armcmc {

void GapEvidence::Add(const std::array<CheckScore, kMaxGapChecks>& scores, double hours) noexcept {
  const double stake = 0.5 * rate_ * (hours + (stakes_ == 0.0 ? 1.0 : 0.0));
  stakes_ += stake;
  const double each = stake / (num_checks_ * static_cast<double>(std::tuple_size_v<Bets>));
  for (int c = 0; c < num_checks_; ++c) {
    const CheckScore& score = scores[static_cast<std::size_t>(c)];
    Bets& bets = capital_[static_cast<std::size_t>(c)];
    for (std::size_t b = 0; b < bets.size(); ++b) {
      const double size = kSizes[b / 2];
      const double sign = b % 2 == 0 ? 1.0 : -1.0;
      const double gain = std::exp(size * (sign * score.z - score.margin) - 0.5 * size * size);
      bets[b] = std::min((bets[b] + each) * gain, kMostCapital);
    }
  }
}

void GapEvidence::Reset() noexcept {
  capital_ = {};
  stakes_ = 0.0;
}

void GapEvidence::Save(SnapshotWriter* out) const noexcept {
  out->Put(stakes_);
  for (const Bets& bets : capital_) out->PutRow(bets.data(), bets.size());
}

void GapEvidence::Restore(SnapshotReader* in) noexcept {
  stakes_ = in->Number();
  in->Require(stakes_ >= 0.0);
  for (Bets& bets : capital_) {
    in->Row(bets.data(), bets.size());
    for (const double capital : bets) in->Require(capital >= 0.0 && capital <= kMostCapital);
  }
}

double GapEvidence::of(int check) const noexcept {
  double sum = 0.0;
  for (const double capital : capital_[static_cast<std::size_t>(check)]) sum += capital;
  return sum;
}

double GapEvidence::total() const noexcept {
  double sum = 0.0;
  for (int c = 0; c < num_checks_; ++c) sum += of(c);
  return sum;
}

}  // namespace armcmc
