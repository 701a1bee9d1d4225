// The bank of filters in a snapshot.
#include <array>
#include <cstdint>
#include <limits>

#include "armcmc/drift.hpp"
#include "armcmc/linear_algebra.hpp"
#include "armcmc/snapshot.hpp"

namespace armcmc {
namespace {

constexpr std::uint8_t kNoBank = 0, kBankOf010 = 1, kBank = 5;
constexpr std::array<int, kBank> kSlotsOf{0, 0, 6, 8, 11};  // of the banks between them, with
constexpr int kFewer = 2;                                   // hypotheses less
constexpr int kFiltersOf010 = 40;
constexpr std::int64_t kBothParts = 4;  // added to the part of the first block

}  // namespace

void Drift::Save(SnapshotWriter* out) const noexcept {
  out->Put(started_ ? kBank : kNoBank);
  if (!started_) return;
  out->Put(time_s_);
  out->Put(static_cast<std::int64_t>(fitted_) + (both_ ? kBothParts : 0));
  const auto put = [out](const auto& m) noexcept ARMCMC_NONBLOCKING {
    out->PutRow(m.data(), static_cast<std::size_t>(m.size()));
  };
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    if (!Exists(i)) continue;
    const Filter& f = bank_[i];
    out->Put(f.weight);
    put(f.u);
    put(f.w);
    put(f.uu);
    put(f.uw);
    put(f.ww);
  }
}

void Drift::Restore(SnapshotReader* in) noexcept {
  Forget();
  const std::uint8_t kind = in->Byte(kBank);
  if (kind == kNoBank) return;
  time_s_ = in->Number();
  if (kind == kBankOf010) (void)in->Integer(0, std::numeric_limits<std::int64_t>::max());  // number of packs
  const std::int64_t fitted = in->Integer(0, static_cast<std::int64_t>(Part::kDrift) + kBothParts);
  if (kind != kBank) {
    const int filters = kind == kBankOf010 ? kFiltersOf010 : kSlotsOf[kind] * (NumHypotheses(dim_) - kFewer);
    const int numbers = filters * (1 + dim_ * (2 + 3 * dim_));
    for (int k = 0; k < numbers; ++k) (void)in->Number();
    return;
  }
  both_ = fitted >= kBothParts;
  fitted_ = static_cast<Part>(both_ ? fitted - kBothParts : fitted);
  const auto take = [in, this](auto* m, Eigen::Index columns) noexcept ARMCMC_NONBLOCKING {
    m->resize(dim_, columns);
    in->Row(m->data(), static_cast<std::size_t>(m->size()));
  };
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    Filter& f = bank_[i];
    f.weight = 0.0;
    if (!Exists(i)) continue;
    f.weight = in->Number();
    take(&f.u, 1);
    take(&f.w, 1);
    take(&f.uu, dim_);
    take(&f.uw, dim_);
    take(&f.ww, dim_);
    in->Require(f.weight == 0.0 || (f.weight > 0.0 && in->good() && IsPositiveDefinite(f.uu)));
  }
  started_ = enabled_ && in->good();
}

}  // namespace armcmc
