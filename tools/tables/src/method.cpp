#include "armcmc/tables/method.hpp"
#include "armcmc/tables/plants/registry.hpp"

namespace armcmc::tables {

std::vector<MethodSpec> PaperMethods(const EstimatorSettings& base) {
  std::vector<MethodSpec> methods;
  const bool contact = kContact.Is(base);
  const auto add = [&](const char* key, const char* label, Method method) -> MethodSpec& {
    MethodSpec spec{key, label, base, 100, true};
    spec.settings.method = method;
    spec.settings.gap_watch.enabled = false;
    methods.push_back(spec);
    return methods.back();
  };
  add("armcmc", "ARMCMC", Method::kArmcmc);
  if (contact) {
    const auto fix_draws = [](MethodSpec* spec, int draws) {
      spec->settings.sampler.rule = DrawRule::kFixed;
      spec->settings.sampler.fixed_draws = draws;
    };
    fix_draws(&add("mcmc_1", "MCMC-1", Method::kMetropolis), 5000);
    MethodSpec& slow = add("mcmc_2", "MCMC-2", Method::kMetropolis);
    fix_draws(&slow, 15'000);
    slow.pack_samples = 200;
  }
  // Forgetting by 1: nothing is forgotten. Chosen on other noise seeds than those of the tables.
  add("rls", "RLS", Method::kRls);
  add("rls_no_forgetting", "RLS without forgetting", Method::kRls).settings.baseline.rls_forgetting = 1.0;
  if (contact) {
    // Geometric mean of the force errors of the paper's, the step and the drift scenario, three noise seeds each, mN:
    // 0.9997: 487, 0.999: 412, 0.997: 492; without forgetting 522, but smaller errors of K and B.
    BaselineSettings& kept = add("rls_no_reset", "RLS without reset", Method::kRls).settings.baseline;
    kept.rls_reset = false;
    kept.rls_forgetting = 0.999;
    BaselineSettings& all = add("rls_keeps_all", "RLS without reset and forgetting", Method::kRls).settings.baseline;
    all.rls_reset = false;
    all.rls_forgetting = 1.0;
  }
  add("pf", "particle filter", Method::kParticleFilter);
  if (!contact) {
    add("rls_per_mode", "RLS, one for each valve", Method::kRls).settings.baseline.recall = true;
    BaselineSettings& all =
        add("rls_per_mode_keeps_all", "RLS, one for each valve, without forgetting", Method::kRls).settings.baseline;
    all.recall = true;
    all.rls_forgetting = 1.0;
    add("pf_per_mode", "particle filter, one for each valve", Method::kParticleFilter).settings.baseline.recall = true;
  } else {
    add("batch_nls", "batch least squares", Method::kArmcmc).online = false;
  }
  return methods;
}

EstimatorSettings ScenarioSettings(const std::string& scenario) {
  if (scenario == kActuator.key("_paper")) return BuiltinSettings(kActuator.key());
  if (scenario == kActuator.key("_excited")) {
    EstimatorSettings excited = BuiltinSettings(kActuator.key("_excited"));
    excited.regress_rate = true;  // the noise of the scenario is that of its sensors
    for (NoiseSettings& noise : excited.noise) noise.std = 500.0;
    return excited;
  }
  EstimatorSettings s = BuiltinSettings(kContact.key());
  NoiseSettings& noise = s.noise[0];
  if (scenario == kContact.key("_heavy_tailed")) {
    noise.kind = NoiseKind::kStudentT;
    noise.dof = 3.0;
  } else if (scenario == kContact.key("_laplace")) {
    noise.kind = NoiseKind::kLaplace;
  } else if (scenario == kContact.key("_impulsive") || scenario == kContact.key("_drift_impulsive")) {
    noise.kind = NoiseKind::kMixture;
  } else if (scenario == kContact.key("_chatter")) {
    noise.std = 0.02;
  }
  return s;
}

}  // namespace armcmc::tables
