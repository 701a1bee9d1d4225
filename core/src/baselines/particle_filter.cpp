#include "armcmc/baselines/particle_filter.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/linear_algebra.hpp"
#include "armcmc/rng.hpp"
#include "simd/kernels.hpp"

namespace armcmc {

// A baseline for comparison, not part of the product: Eigen's products and factorisations are used as in text books.
// All types are bounded; the allocation tests and RealtimeSanitizer cover all of it.
ARMCMC_TRUST_NONBLOCKING_BEGIN

class ParticleFilter::Numbers {
 public:
  Numbers(std::uint64_t seed, std::uint64_t pack, std::uint64_t mode, const MarginalTable& normal)
      : stream_(seed, pack, mode), normal_(normal) {}
  double Uniform() noexcept { return stream_.Uniform(); }
  double Normal() noexcept { return normal_.Draw(stream_.Uniform()); }

 private:
  RandomStream stream_;
  const MarginalTable& normal_;
};

ParticleFilter::ParticleFilter(const FilterParts& parts)
    : parts_(parts), normal_table_(MarginalTable::Normal()), count_(parts.settings.baseline.particles) {
  const auto size = static_cast<std::size_t>(RoundUpToTile(count_));
  for (int d = 0; d < parts_.space.dim; ++d) {
    u_[static_cast<std::size_t>(d)].assign(size, 0.0);
    spare_[static_cast<std::size_t>(d)].assign(size, 0.0);
  }
  for (auto* v : {&log_weight_, &weight_, &log_likelihood_}) v->assign(size, 0.0);
}

void ParticleFilter::Resume() noexcept {
  if (!parts_.settings.baseline.recall) Reset();
}

void ParticleFilter::Start(Numbers* numbers) noexcept {
  const ParameterSpace& s = parts_.space;
  for (int d = 0; d < s.dim; ++d) {
    const auto i = static_cast<std::size_t>(d);
    for (int k = 0; k < count_; ++k) {
      const double reach = s.upper[i] - s.lower[i];
      const double draw = s.normal[i] > 0.0 ? numbers->Normal() : s.lower[i] + reach * numbers->Uniform();
      // A draw outside the bounds, which is rare, is replaced by a uniform one inside.
      const bool inside = draw > s.lower[i] && draw < s.upper[i];
      u_[i][static_cast<std::size_t>(k)] = inside ? draw : s.lower[i] + reach * numbers->Uniform();
    }
  }
  std::fill(log_weight_.begin(), log_weight_.end(), 0.0);
  started_ = true;
  known_ = false;
}

void ParticleFilter::Walk(double sd, Numbers* numbers) noexcept {
  const ParameterSpace& s = parts_.space;
  for (int d = 0; d < s.dim; ++d) {
    const auto i = static_cast<std::size_t>(d);
    for (int k = 0; k < count_; ++k) {
      double& u = u_[i][static_cast<std::size_t>(k)];
      u = std::clamp(u + sd * numbers->Normal(), s.lower[i], s.upper[i]);
    }
  }
}

void ParticleFilter::Score(const ModeData& data) noexcept {
  std::array<const double*, kMaxParams> rows{};
  for (int d = 0; d < parts_.space.dim; ++d) rows[static_cast<std::size_t>(d)] = u_[static_cast<std::size_t>(d)].data();
  alignas(64) std::array<double, kTileLanes> log_scale;
  for (int k = 0; k < count_; k += kTileLanes) {
    parts_.kernels.to_physical(parts_.space, rows.data(), k, &theta_, log_scale.data());
    parts_.kernels.score(parts_.model, parts_.noise, data, theta_, log_scale.data(), &prediction_,
                         &log_likelihood_[static_cast<std::size_t>(k)]);
  }
}

double ParticleFilter::Normalise() noexcept {
  double top = -HUGE_VAL;
  for (int k = 0; k < count_; ++k) top = std::fmax(top, log_weight_[static_cast<std::size_t>(k)]);
  if (!std::isfinite(top)) return 0.0;
  double sum = 0.0, square = 0.0;
  for (int k = 0; k < count_; ++k) {
    const auto i = static_cast<std::size_t>(k);
    weight_[i] = std::exp(log_weight_[i] - top);
    sum += weight_[i];
    square += weight_[i] * weight_[i];
  }
  for (int k = 0; k < count_; ++k) weight_[static_cast<std::size_t>(k)] /= sum;
  return sum * sum / square;
}

double ParticleFilter::NextStep(double left) const noexcept {
  const auto effective = [&](double step) noexcept {
    double top = -HUGE_VAL;
    for (int k = 0; k < count_; ++k) {
      const auto i = static_cast<std::size_t>(k);
      top = std::fmax(top, log_weight_[i] + step * log_likelihood_[i]);
    }
    double sum = 0.0, square = 0.0;
    for (int k = 0; k < count_; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double w = std::exp(log_weight_[i] + step * log_likelihood_[i] - top);
      sum += w;
      square += w * w;
    }
    return sum * sum / square;
  };
  const double wanted = 0.5 * count_;
  if (effective(left) >= wanted) return left;
  double lo = -40.0, hi = 0.0;  // log of the share of what is left
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (lo + hi);
    (effective(left * std::exp(middle)) >= wanted ? lo : hi) = middle;
  }
  return left * std::exp(lo);
}

void ParticleFilter::Resample(Numbers* numbers) noexcept {
  const double offset = numbers->Uniform();
  double below = 0.0;
  int source = 0;
  for (int k = 0; k < count_; ++k) {
    const double at = (k + offset) / count_;
    while (source < count_ - 1 && below + weight_[static_cast<std::size_t>(source)] < at)
      below += weight_[static_cast<std::size_t>(source++)];
    for (int d = 0; d < parts_.space.dim; ++d)
      spare_[static_cast<std::size_t>(d)][static_cast<std::size_t>(k)] =
          u_[static_cast<std::size_t>(d)][static_cast<std::size_t>(source)];
  }
  for (int d = 0; d < parts_.space.dim; ++d) u_[static_cast<std::size_t>(d)].swap(spare_[static_cast<std::size_t>(d)]);
  std::fill(log_weight_.begin(), log_weight_.end(), 0.0);
}

void ParticleFilter::Move(Numbers* numbers) noexcept {
  const ParameterSpace& s = parts_.space;
  ParamVector mean = ParamVector::Zero(s.dim);
  ParamMatrix covariance = ParamMatrix::Zero(s.dim, s.dim);
  ParamVector u(s.dim), z(s.dim);
  const auto read = [&](int k) noexcept {
    for (int d = 0; d < s.dim; ++d) u[d] = u_[static_cast<std::size_t>(d)][static_cast<std::size_t>(k)];
  };
  for (int k = 0; k < count_; ++k) {
    read(k);
    mean += u / count_;
  }
  for (int k = 0; k < count_; ++k) {
    read(k);
    covariance += (u - mean) * (u - mean).transpose() / count_;
  }
  for (int d = 0; d < s.dim; ++d) covariance(d, d) = covariance(d, d) * (1.0 + 1e-12) + 1e-30;
  ParamMatrix root;
  if (!CholeskyFactor(covariance, &root)) root = covariance.diagonal().cwiseSqrt().asDiagonal();
  const double shrink = std::sqrt(1.0 - kKernel * kKernel);
  for (int k = 0; k < count_; ++k) {
    read(k);
    for (int d = 0; d < s.dim; ++d) z[d] = numbers->Normal();
    const ParamVector moved = mean + shrink * (u - mean) + kKernel * Multiply(root, z);
    for (int d = 0; d < s.dim; ++d) {
      const auto i = static_cast<std::size_t>(d);
      u_[i][static_cast<std::size_t>(k)] = std::clamp(moved[d], s.lower[i], s.upper[i]);
    }
  }
}

bool ParticleFilter::Update(const ModeData& data, Numbers* numbers) noexcept {
  double done = 0.0;
  for (int stage = 0; stage < kMaxStages && done < 1.0; ++stage) {
    Score(data);
    const double left = 1.0 - done;
    const double step = stage + 1 < kMaxStages ? NextStep(left) : left;
    for (int k = 0; k < count_; ++k) {
      const auto i = static_cast<std::size_t>(k);
      log_weight_[i] += step * log_likelihood_[i];
      if (std::isnan(log_weight_[i])) log_weight_[i] = -HUGE_VAL;
    }
    done = step >= left ? 1.0 : done + step;
    const double effective = Normalise();
    if (!(effective > 0.0)) return false;
    if (effective >= 0.75 * count_) continue;
    Resample(numbers);
    Move(numbers);
  }
  return true;
}

Status ParticleFilter::Run(const ModeData& data, std::uint64_t pack, std::uint64_t mode, Nanos, ClockRef, int,
                           ModeDraws* out) noexcept {
  Numbers numbers(parts_.settings.sampler.seed, pack, mode, normal_table_);
  if (!started_) {
    Start(&numbers);
  } else {
    const double packs = pack > last_pack_ ? static_cast<double>(pack - last_pack_) : 1.0;
    Walk(parts_.settings.baseline.pf_jitter * std::sqrt(packs), &numbers);
  }
  last_pack_ = pack;
  const int updates = std::min(parts_.settings.baseline.pf_updates, data.num_samples);
  bool good = true;
  for (int c = 0; c < updates && good; ++c) {
    const int from = data.num_samples * c / updates;
    const int to = data.num_samples * (c + 1) / updates;
    if (updates == 1) {
      good = Update(data, &numbers);
      break;
    }
    chunk_.num_samples = to - from;
    chunk_.weighted = data.weighted;
    chunk_.pack_share = data.pack_share;
    std::copy(data.target.begin() + from, data.target.begin() + to, chunk_.target.begin());
    std::copy(data.weight.begin() + from, data.weight.begin() + to, chunk_.weight.begin());
    chunk_.compiled = data.compiled;
    chunk_.mode = data.mode;
    chunk_.tape = data.tape;
    chunk_.error_tape = data.error_tape;
    chunk_.num_tapes = data.num_tapes;
    chunk_.law = data.law;
    chunk_.scalars = data.scalars;
    chunk_.past = data.past;
    chunk_.states = data.states;
    chunk_.start_fit = nullptr;  // its directions are those of the whole pack
    std::copy(data.sample.begin() + from, data.sample.begin() + to, chunk_.sample.begin());
    for (std::size_t f = 0; f < data.feature.size(); ++f)
      std::copy(data.feature[f].begin() + from, data.feature[f].begin() + to, chunk_.feature[f].begin());
    good = Update(chunk_, &numbers);
  }
  const double effective = good ? Normalise() : 0.0;
  if (!(effective > 0.0)) {
    Reset();
    return Status::kNonFinite;
  }
  FillStep(data, count_, 0, out);
  out->kish_ess = effective;
  // The chain is a systematic resample of the particles.
  const double offset = numbers.Uniform();
  double below = 0.0;
  int source = 0;
  std::fill(out->visits, out->visits + count_, 0);
  for (int k = 0; k < count_; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double at = (k + offset) / count_;
    while (source < count_ - 1 && below + weight_[static_cast<std::size_t>(source)] < at)
      below += weight_[static_cast<std::size_t>(source++)];
    out->chain[k] = source;
    ++out->visits[source];
    out->weight[k] = weight_[i];
    for (int d = 0; d < parts_.space.dim; ++d)
      out->u[static_cast<std::size_t>(d)][k] = u_[static_cast<std::size_t>(d)][i];
  }
  known_ = known_ || IsInformed(parts_.space, *out);
  out->known = known_;
  return Status::kOk;
}

ARMCMC_TRUST_NONBLOCKING_END

}  // namespace armcmc
