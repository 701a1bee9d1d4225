#include "armcmc/posterior_memory.hpp"

#include "armcmc/prefetch.hpp"
#include "armcmc/snapshot.hpp"

namespace armcmc {
namespace {

void SaveBlock(const DensityBlock& b, const std::array<MarginalTable, kMaxParams>& tables,
               SnapshotWriter* out) noexcept ARMCMC_NONBLOCKING {
  out->PutFlag(b.bent);
  out->PutFlag(b.tapered);
  out->PutRow(b.mean.data(), b.mean.size());
  for (const auto& row : b.whiten) out->PutRow(row.data(), row.size());
  for (const auto& row : b.unwhiten) out->PutRow(row.data(), row.size());
  for (const auto& row : b.poly) out->PutRow(row.data(), row.size());
  for (const auto& row : b.linear) out->PutRow(row.data(), row.size());
  out->PutRow(b.cross.data(), b.cross.size());
  out->PutRow(b.square.data(), b.square.size());
  for (const auto& row : b.thickness) out->PutRow(row.data(), row.size());
  out->PutRow(b.center.data(), b.center.size());
  out->PutRow(b.scale.data(), b.scale.size());
  out->Put(b.norm);
  for (std::size_t d = 0; d < static_cast<std::size_t>(b.dim); ++d) {
    const bool own = b.marginal[d] == &tables[d];
    out->PutFlag(own);
    if (own) tables[d].Save(out);
  }
}

void RestoreBlock(int dim, const MarginalTable& shared, SnapshotReader* in, DensityBlock* b,
                  std::array<MarginalTable, kMaxParams>* tables) noexcept ARMCMC_NONBLOCKING {
  *b = DensityBlock{};
  b->dim = dim;
  b->bent = in->Flag();
  b->tapered = in->Flag();
  in->Row(b->mean.data(), b->mean.size());
  for (auto& row : b->whiten) in->Row(row.data(), row.size());
  for (auto& row : b->unwhiten) in->Row(row.data(), row.size());
  for (auto& row : b->poly) in->Row(row.data(), row.size());
  for (auto& row : b->linear) in->Row(row.data(), row.size());
  in->Row(b->cross.data(), b->cross.size());
  in->Row(b->square.data(), b->square.size());
  for (auto& row : b->thickness) in->Row(row.data(), row.size());
  in->Row(b->center.data(), b->center.size());
  in->Row(b->scale.data(), b->scale.size());
  b->norm = in->Number();
  in->Require(b->norm > 0.0);
  for (std::size_t d = 0; d < static_cast<std::size_t>(dim); ++d) {
    in->Require(b->scale[d] > 0.0);
    const bool own = in->Flag();
    if (own) (*tables)[d].Restore(in);
    b->marginal[d] = own ? &(*tables)[d] : &shared;
  }
}

}  // namespace

void PosteriorMemory::Prefetch() const noexcept {
  if (!valid) return;
  for (std::size_t b = 0; b < static_cast<std::size_t>(num_blocks); ++b) {
    armcmc::Prefetch(&block[b], sizeof block[b]);
    for (std::size_t d = 0; d < static_cast<std::size_t>(block[b].dim); ++d) block[b].marginal[d]->Prefetch();
  }
}

void PosteriorMemory::Save(SnapshotWriter* out) const noexcept {
  out->PutFlag(valid);
  if (!valid) return;
  out->PutFlag(informed);
  out->Put(std::int64_t{num_blocks});
  out->PutRow(weight.data(), kStoredBlocks);
  for (std::size_t b = 0; b < static_cast<std::size_t>(num_blocks); ++b) SaveBlock(block[b], tables[b], out);
  out->PutRow(mean.data(), static_cast<std::size_t>(mean.size()));
  out->PutRow(covariance.data(), static_cast<std::size_t>(covariance.size()));
  out->Put(log_noise_scale);
}

void PosteriorMemory::Restore(int dim, const MarginalTable& shared, SnapshotReader* in) noexcept {
  valid = in->Flag();
  if (!valid) return;
  informed = in->Flag();
  num_blocks = static_cast<int>(in->Integer(1, kStoredBlocks));
  weight = {};
  in->Row(weight.data(), kStoredBlocks);
  double total = 0.0;
  for (std::size_t b = 0; b < static_cast<std::size_t>(num_blocks); ++b) {
    in->Require(weight[b] >= 0.0);
    total += weight[b];
    RestoreBlock(dim, shared, in, &block[b], &tables[b]);
  }
  in->Require(std::fabs(total - 1.0) < 1e-9);
  mean.resize(dim);
  covariance.resize(dim, dim);
  in->Row(mean.data(), static_cast<std::size_t>(dim));
  in->Row(covariance.data(), static_cast<std::size_t>(dim * dim));
  in->Require(in->good() && IsPositiveDefinite(covariance));
  log_noise_scale = in->Number();
  valid = in->good();
}

}  // namespace armcmc
