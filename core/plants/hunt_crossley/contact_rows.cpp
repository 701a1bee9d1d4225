#include "plants/hunt_crossley/contact_rows.hpp"

#include <algorithm>
#include <cmath>

namespace armcmc {
namespace {

constexpr double kLagMemory = 8.0;  // time constants after which a low pass has forgotten its start

double GateOf(EffectGate gate, double from_s, double until_s, const EffectInput& in) noexcept {
  switch (gate) {
    case EffectGate::kContact: return in.x >= 0.0 ? 1.0 : 0.0;
    case EffectGate::kFree: return in.x >= 0.0 ? 0.0 : 1.0;
    case EffectGate::kFrom: return in.t >= from_s ? 1.0 : 0.0;
    case EffectGate::kUntil: return in.t < until_s ? 1.0 : 0.0;
    case EffectGate::kAlways: break;
  }
  return 1.0;
}

}  // namespace

ContactRows::ContactRows(const EstimatorSettings& settings) : num_terms_(settings.num_effects) {
  int parameter = settings.num_parameters;
  for (int e = 0; e < num_terms_; ++e) {
    const EffectSettings& effect = settings.effects[static_cast<std::size_t>(e)];
    const auto index = static_cast<std::size_t>(ContactEffects::Find(effect.name));
    Term& term = terms_[static_cast<std::size_t>(e)];
    term.info = ContactEffects::kInfos[index];
    term.feature = kContactFeatures[index];
    term.shapes = effect.shapes;
    term.gate = effect.gate;
    term.from_s = effect.from_s;
    term.until_s = effect.until_s;
    term.parameter = parameter;
    parameter += term.info->num_amplitudes;
    if (term.info->slot == EffectSlot::kInputMap) {
      surface_ = e;
      const ParameterSettings& prior = effect.amplitudes[0];
      surface_m_ = prior.prior == PriorKind::kNormal ? prior.mean : 0.5 * (prior.lower + prior.upper);
    }
    if (term.info->slot == EffectSlot::kSensorDelay) longest_delay_ = effect.amplitudes[0].upper;
    if (term.info->slot == EffectSlot::kSensorLag) longest_lag_ = effect.amplitudes[0].upper;
  }
  Assign(&memory_[0].pack);
  Assign(&memory_[1].pack);
}

std::unique_ptr<CompiledPack> ContactRows::MakePack() const { return std::make_unique<ContactPack>(); }

void ContactRows::Assign(ContactPack* pack) const noexcept {
  for (int i = 0; i < num_terms_; ++i) {
    const Term& term = terms_[static_cast<std::size_t>(i)];
    switch (term.info->slot) {
      case EffectSlot::kInputMap: pack->contact_offset = term.parameter; break;
      case EffectSlot::kConstitutiveLaw: pack->stiffness_rate = term.parameter; break;
      case EffectSlot::kSensorDelay: pack->delay = term.parameter; break;
      case EffectSlot::kSensorLag: pack->lag = term.parameter; break;
      case EffectSlot::kSensorStatics: pack->limit = term.parameter; break;
      case EffectSlot::kAdditive:
        for (int a = 0; a < term.info->num_amplitudes; ++a)
          pack->additive_amplitude[static_cast<std::size_t>(pack->num_additive++)] = term.parameter + a;
        break;
    }
  }
}

int ContactRows::HistoryFor(double dt) const noexcept {
  const double samples = (longest_delay_ + kLagMemory * longest_lag_) / dt;
  if (!(samples > 0.0)) return 0;
  return static_cast<int>(std::fmin(std::ceil(samples) + 1.0, kMaxHistory));
}

void ContactRows::CopyRows(const ContactPack& from, int first, int count, ContactPack* to) noexcept {
  const auto copy = [&](const ContactPack::Row& source, ContactPack::Row* target) noexcept {
    std::copy_n(source.begin() + first, count, target->begin());
  };
  copy(from.x, &to->x);
  copy(from.log2_x, &to->log2_x);
  copy(from.v, &to->v);
  for (std::size_t a = 0; a < static_cast<std::size_t>(from.num_additive); ++a) copy(from.feature[a], &to->feature[a]);
  copy(from.elapsed, &to->elapsed);
  copy(from.contact_offset_gate, &to->contact_offset_gate);
  copy(from.delay_gate, &to->delay_gate);
  copy(from.lag_gate, &to->lag_gate);
  copy(from.limit_gate, &to->limit_gate);
}

EffectInput ContactRows::FromSurface(EffectInput in) const noexcept {
  if (surface_ < 0) return in;
  const Term& term = terms_[static_cast<std::size_t>(surface_)];
  in.x -= surface_m_ * GateOf(term.gate, term.from_s, term.until_s, in);
  return in;
}

void ContactRows::FillRow(const EffectInput& in, int row, Memory* memory) const noexcept {
  const auto r = static_cast<std::size_t>(row);
  ContactPack& pack = memory->pack;
  pack.x[r] = in.x;
  pack.v[r] = in.v;
  pack.log2_x[r] = in.x > 0.0 ? std::fmax(std::log2(in.x), ContactPack::kNoDepth) : ContactPack::kNoDepth;
  const EffectInput from_surface = FromSurface(in);
  std::size_t next = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_terms_); ++i) {
    const Term& term = terms_[i];
    const double gate = GateOf(term.gate, term.from_s, term.until_s, in);
    std::array<double, kMaxEffectAmplitudes> feature{};
    // A closed gate hides the feature; its memory goes on.
    if (term.feature != nullptr)
      term.feature(from_surface, term.shapes.data(), memory->filter[i].data(), feature.data());
    switch (term.info->slot) {
      case EffectSlot::kInputMap: pack.contact_offset_gate[r] = gate; break;
      case EffectSlot::kConstitutiveLaw: pack.elapsed[r] = gate * feature[0]; break;
      case EffectSlot::kSensorDelay: pack.delay_gate[r] = gate; break;
      case EffectSlot::kSensorLag: pack.lag_gate[r] = gate; break;
      case EffectSlot::kSensorStatics: pack.limit_gate[r] = gate; break;
      case EffectSlot::kAdditive:
        for (std::size_t a = 0; a < static_cast<std::size_t>(term.info->num_amplitudes); ++a)
          pack.feature[next++][r] = gate * feature[a];
        break;
    }
  }
}

bool ContactRows::Prepare(const DataPack& pack, CompiledPack* compiled) noexcept {
  auto* out = static_cast<ContactPack*>(compiled);
  const Memory& before = memory_[static_cast<std::size_t>(current_)];
  Memory& after = memory_[static_cast<std::size_t>(1 - current_)];
  const bool continues = before.last.ContinuesWith(pack);
  after.last = LastPack::Of(pack);
  after.filter = before.filter;
  ContactPack& rows = after.pack;
  rows.dt = pack.dt;
  rows.num_samples = pack.num_samples;
  rows.history = continues ? std::min(HistoryFor(pack.dt), before.pack.rows()) : 0;
  CopyRows(before.pack, before.pack.rows() - rows.history, rows.history, &rows);
  for (int n = 0; n < pack.num_samples; ++n) {
    const auto& u = pack.u[static_cast<std::size_t>(n)];
    const EffectInput in{.t = pack.t_last_s - (pack.num_samples - 1 - n) * pack.dt,
                         .dt = pack.dt,
                         .x = u[0],
                         .v = u[1],
                         .first = n == 0 && !continues};
    FillRow(in, rows.history + n, &after);
  }
  bool finite = true;
  for (int r = rows.history; r < rows.rows(); ++r) {
    const auto i = static_cast<std::size_t>(r);
    finite = finite && std::isfinite(rows.elapsed[i]);
    for (std::size_t a = 0; a < static_cast<std::size_t>(rows.num_additive); ++a)
      finite = finite && std::isfinite(rows.feature[a][i]);
  }
  if (!finite) return false;
  current_ = 1 - current_;
  // Members by hand: rows past the last are not copied.
  out->history = rows.history;
  out->num_samples = rows.num_samples;
  out->dt = rows.dt;
  out->num_additive = rows.num_additive;
  out->additive_amplitude = rows.additive_amplitude;
  out->stiffness_rate = rows.stiffness_rate;
  out->contact_offset = rows.contact_offset;
  out->delay = rows.delay;
  out->lag = rows.lag;
  out->limit = rows.limit;
  CopyRows(rows, 0, rows.rows(), out);
  return true;
}

void ContactRows::Fill(const DataPack& pack, const CompiledPack& rows, int, ModeData* data) const noexcept {
  data->num_samples = pack.num_samples;
  std::copy_n(pack.y.begin(), pack.num_samples, data->target.begin());
  for (int n = 0; n < pack.num_samples; ++n) data->sample[static_cast<std::size_t>(n)] = static_cast<std::int16_t>(n);
  data->compiled = &rows;
}

void ContactRows::Reset() noexcept { memory_[0].last = memory_[1].last = {}; }

}  // namespace armcmc
