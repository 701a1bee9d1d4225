#include "gap/plants/hunt_crossley/contact_forms.hpp"

#include <array>
#include <utility>

#include "plants/hunt_crossley/effects.hpp"

namespace armcmc::gap {
namespace {

/// The estimator's own feature of an additive effect, over the whole recording.
Matrix CoreFeature(int effect, const Signals& s, const double* shape_values) {
  const auto index = static_cast<std::size_t>(effect);
  const EffectFeatureFn feature = kContactFeatures[index];
  Matrix columns(s.rows(), ContactEffects::kInfos[index]->num_amplitudes);
  std::array<double, kEffectMemory> memory{};
  std::array<double, kMaxEffectAmplitudes> value{};
  for (Eigen::Index i = 0; i < s.rows(); ++i) {
    const EffectInput in{
        .t = s.t[i], .dt = s.dt, .x = s.at(Role::kPosition)[i], .v = s.at(Role::kVelocity)[i], .first = i == 0};
    feature(in, shape_values, memory.data(), value.data());
    for (Eigen::Index a = 0; a < columns.cols(); ++a) columns(i, a) = value[static_cast<std::size_t>(a)];
  }
  return columns;
}

}  // namespace

EffectForm FromCore(const char* name, std::vector<Coordinate> coordinates) {
  const int index = ContactEffects::Find(name);
  const EffectInfo& info = *ContactEffects::kInfos[static_cast<std::size_t>(index)];
  EffectForm form;
  form.effect = name;
  form.family = info.family;
  form.formula = info.formula;
  form.slot = Slot::kAdditive;
  form.coordinates = std::move(coordinates);
  form.num_amplitudes = info.num_amplitudes;
  form.from_surface = info.name == Adhesion::kInfo.name || info.name == StressRelaxation::kInfo.name;
  const std::vector<Coordinate> all = form.coordinates;
  const int amplitudes = form.num_amplitudes;
  form.features = [index, all, amplitudes](const Signals& s, const double* shape) {
    std::array<double, kMaxEffectShapes> values{};
    for (std::size_t i = static_cast<std::size_t>(amplitudes); i < all.size(); ++i)
      values[i - static_cast<std::size_t>(amplitudes)] = all[i].Value(shape[i - static_cast<std::size_t>(amplitudes)]);
    Matrix columns = CoreFeature(index, s, values.data());
    for (Eigen::Index a = 0; a < columns.cols(); ++a) columns.col(a) *= all[static_cast<std::size_t>(a)].unit_size;
    return columns;
  };
  return form;
}

EffectForm Reformulated(const EffectForm& base, const char* variant, const char* formula,
                        std::vector<Coordinate> coordinates, int num_amplitudes) {
  EffectForm form = base;
  form.variant = variant;
  form.formula = formula;
  form.coordinates = std::move(coordinates);
  form.num_amplitudes = num_amplitudes;
  form.features = nullptr;
  form.starts.clear();
  return form;
}

}  // namespace armcmc::gap
