#include "armcmc/gap/features.hpp"
#include "armcmc/gap/law_error.hpp"
#include "gap/plants/hunt_crossley/contact_forms.hpp"

namespace armcmc::gap {

void AddUnlisted(const Signals& s, std::vector<EffectForm>* out) {
  const double force = s.output_scale, speed = s.scale_of(Role::kVelocity), length = s.scale_of(Role::kPosition);
  EffectForm drag;
  drag.listed = false;
  drag.effect = "drag that grows with the square of speed";
  drag.family = "quadratic drag";
  drag.formula = "f + drag v |v|";
  drag.coordinates = {AmplitudeOf("drag", "N s^2/m^2", force / (speed * speed), true)};
  drag.features = [](const Signals& in, const double*) -> Matrix {
    const Vector u = in.at(Role::kVelocity) / in.scale_of(Role::kVelocity);
    return in.output_scale * u.cwiseProduct(u.cwiseAbs());
  };
  SetStarts(&drag, {});
  out->push_back(drag);

  EffectForm stiffening = drag;
  stiffening.effect = "stiffness that grows with depth";
  stiffening.family = "strain stiffening";
  stiffening.formula = "K (1 + share (exp(x / length) - 1)) in place of K";
  stiffening.slot = Slot::kParameter;
  stiffening.coordinates = {{"share", "-", -0.9, 30.0, 0.0, 0.5, 1.0, false},
                            ShapeOf("length", "m", length, 0.15, 2.0)};
  stiffening.features = [stiffening](const Signals& in, const double* shape) -> Matrix {
    const double scale = ShapeValue(stiffening, 0, shape);
    return Exp((in.at(Role::kPosition).cwiseMax(0.0) / scale).cwiseMin(30.0)).array() - 1.0;
  };
  SetStarts(&stiffening, {4});
  out->push_back(stiffening);

  EffectForm ripple = drag;
  ripple.effect = "a ripple along the path";
  ripple.family = "spatial ripple";
  ripple.formula = "f + cosine cos(2 pi x / wavelength) + sine sin(2 pi x / wavelength) in contact";
  ripple.num_amplitudes = 2;
  ripple.coordinates = {AmplitudeOf("cosine", "N", force, false), AmplitudeOf("sine", "N", force, false),
                        ShapeOf("wavelength", "m", length, 0.08, 2.0)};
  ripple.features = [ripple](const Signals& in, const double* shape) -> Matrix {
    return in.output_scale * Gated(Waves(in.at(Role::kPosition), 1.0 / ShapeValue(ripple, 0, shape), 1, 1), in.active);
  };
  SetStarts(&ripple, {24});
  out->push_back(ripple);

  EffectForm load = drag;
  load.effect = "friction that grows with the contact force";
  load.family = "load friction";
  load.formula = "f + share K x^p tanh(v / speed)";
  load.slot = Slot::kMemory;
  load.coordinates = {AmplitudeOf("share", "-", 1.0, true, 0.3), ShapeOf("speed", "m/s", speed, 0.003, 0.4)};
  load.filter = [load](const Signals& in, const Vector& series, int, const double* shape) -> Vector {
    return series.cwiseProduct(Tanh(in.at(Role::kVelocity) / ShapeValue(load, 0, shape)));
  };
  SetStarts(&load, {3});
  out->push_back(load);

  if (!s.law_seen) return;
  constexpr double kFast = 2.0;  // times the rms speed
  out->push_back(LawErrorForm({Role::kPosition, 0.0, s.at(Role::kPosition).maxCoeff()},
                              {Role::kVelocity, 0.0, kFast * speed, true}));
}

}  // namespace armcmc::gap
