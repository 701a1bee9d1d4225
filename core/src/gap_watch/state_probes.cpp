#include "armcmc/gap_watch/state_probes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gap_tools.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

using expression::SymbolKind;

constexpr double kFirstSize = 1e-6;
constexpr double kTermEffect = 0.1;   // of a term on the output, rms in units of the noise
constexpr double kFaintest = 1e-300;  // size and effect of terms stay numbers
constexpr double kStrongest = 1e100;

/// A term and the state in whose rate it stands.
struct ProbeTerm {
  std::string name;
  std::size_t state = 0;
  std::string text;
};

/// The state that a force on state s moves first: positions are moved by way of their velocity.
std::size_t MovedBy(const Plant& plant, std::size_t s) {
  for (std::size_t hop = 0; hop < plant.states().size(); ++hop) {
    std::size_t next = s;
    for (std::size_t r = 0; r < plant.states().size(); ++r)
      if (plant.states()[s].rate == plant.NodeOf(SymbolKind::kState, static_cast<int>(r))) next = r;
    if (next == s) break;
    s = next;
  }
  return s;
}

/// The likeliest first: where room is short, the others are left out.
std::vector<ProbeTerm> TermsOf(const Plant& plant) {
  const PlantDescription& description = plant.description();
  std::vector<ProbeTerm> terms, later;
  std::vector<bool> pushed(description.states.size(), false);
  for (std::size_t s = 0; s < description.states.size(); ++s) {
    const StateDescription& state = description.states[s];
    const std::string& x = state.name;
    const std::size_t at = MovedBy(plant, s);
    if (state.role == "velocity") {
      terms.push_back({"direction_of_" + x, at, "sign(" + x + ")"});
      terms.push_back({"drag_of_" + x, at, x + "*abs(" + x + ")"});
    } else {
      terms.push_back({"square_of_" + x, at, x + "^2"});
      terms.push_back({"cube_of_" + x, at, x + "^3"});
    }
    later.push_back({x, at, x});
    if (!pushed[at]) later.push_back({"push_on_" + description.states[at].name, at, "1"});
    pushed[at] = true;
  }
  terms.insert(terms.end(), later.begin(), later.end());
  for (std::size_t s = 0; s < description.signals.size(); ++s) {
    const std::string& u = description.signals[s].name;
    for (std::size_t r = 0; r < plant.states().size() && static_cast<int>(s) != plant.output(); ++r)
      if (plant.graph().DependsOn(plant.states()[r].rate, plant.NodeOf(SymbolKind::kSignal, static_cast<int>(s))))
        terms.push_back({"bent_" + u, r, u + "*abs(" + u + ")"});
  }
  return terms;
}

/// @return null where the plant with these terms is past a limit.
std::unique_ptr<const PlantProgram> WithTerms(const PlantProgram& base, const std::vector<ProbeTerm>& terms) {
  PlantDescription description = base.plant().description();
  description.noise.estimate = false;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const std::string amplitude = "size_of_term_" + std::to_string(i);
    // A unit that depends on a name is not checked.
    description.parameters.push_back({amplitude, "1^unit", "normal", 0.0, 1.0});
    std::string& rate = description.states[terms[i].state].rate;
    rate = "(" + rate + ") + " + amplitude + "*(" + terms[i].text + ")";
  }
  try {
    auto plant = std::make_shared<const Plant>(std::move(description));
    auto program = std::make_unique<const PlantProgram>(std::move(plant));
    const bool same = program->states().size() == base.states().size() && program->info().num_modes == 1 &&
                      program->sampled().size() == base.sampled().size() + terms.size();
    return same ? std::move(program) : nullptr;
  } catch (const PlantError&) {
    return nullptr;
  }
}

int MostSamples(const PlantStates& states) {
  return std::min(kMaxPackSamples, 1 + kMaxStateCells / (states.substeps() * std::max(1, states.step().num_scalars)));
}

}  // namespace

StateProbes::StateProbes(const PlantProgram& plant, const simd::Kernels& kernels, int room)
    : kernels_(kernels),
      num_parameters_(static_cast<int>(plant.sampled().size())),
      most_samples_(MostSamples(plant.states())) {
  std::vector<ProbeTerm> group;
  std::unique_ptr<const PlantProgram> program;
  const auto close = [&] {
    if (group.empty()) return;
    most_samples_ = std::min(most_samples_, MostSamples(program->states()));
    Group& made = groups_.emplace_back();
    made.first = size();
    made.count = static_cast<int>(group.size());
    made.program = std::move(program);
    for (const ProbeTerm& term : group) names_.push_back(term.name);
    group.clear();
  };
  for (const ProbeTerm& term : TermsOf(plant.plant())) {
    if (size() + static_cast<int>(group.size()) == room) break;
    group.push_back(term);
    if (auto larger = WithTerms(plant, group); larger != nullptr) {
      program = std::move(larger);
      continue;
    }
    group.pop_back();
    close();
    group = {term};
    program = WithTerms(plant, group);
    if (program == nullptr) group.clear();
  }
  close();
  size_.fill(kFirstSize);
}

void StateProbes::Fill(const DataPack& pack, const std::array<double, kMaxParams>& theta,
                       const std::array<double, kMaxStates>& start, double noise_std, int first,
                       RegionTemplates* out) noexcept {
  const bool continues = last_.ContinuesWith(pack);
  last_ = LastPack::Of(pack);
  for (int i = 0; i < size(); ++i) std::fill_n((*out)[At(first + i)].begin(), pack.num_samples, 0.0);
  for (Group& group : groups_) {
    if (!continues) group.memory.Clear();
    if (!group.program->Prepare(pack, &group.memory, nullptr, &pack_)) {
      last_ = LastPack{};
      continue;
    }
    group.program->Fill(pack_, pack.num_samples, 0, &data_);
    for (std::size_t s = 0; s < kMaxStates; ++s) {
      pack_.states.given[s] = true;
      pack_.states.value[s] = start[s];
    }
    if (data_.num_samples > 0) Respond(group, theta, noise_std, pack.num_samples, first, out);
  }
}

void StateProbes::Respond(const Group& group, const std::array<double, kMaxParams>& theta, double noise_std,
                          int num_samples, int first, RegionTemplates* out) noexcept {
  for (int d = 0; d < num_parameters_; ++d) theta_.value[At(d)].fill(theta[At(d)]);
  for (int i = 0; i < group.count; ++i) {
    auto& lanes = theta_.value[At(num_parameters_ + i)];
    lanes.fill(0.0);
    lanes[At(2 * i)] = size_[At(group.first + i)];
    lanes[At(2 * i + 1)] = -size_[At(group.first + i)];
  }
  kernels_.run_states(data_, theta_, offset_, &end_, &law_);
  for (int i = 0; i < group.count; ++i) {
    double& size = size_[At(group.first + i)];
    auto& phi = (*out)[At(first + group.first + i)];
    double square = 0.0;
    for (std::size_t k = 0; k < At(data_.num_samples); ++k) {
      const auto& law = law_.value[k];
      const double answer = (law[At(2 * i)] - law[At(2 * i + 1)]) / (2.0 * size * noise_std);
      phi[static_cast<std::size_t>(data_.sample[k])] = answer;
      square += answer * answer;
    }
    if (!std::isfinite(square)) {
      std::fill_n(phi.begin(), num_samples, 0.0);
      size = std::max(1e-3 * size, kFaintest);
    } else if (const double effect = std::sqrt(square / data_.num_samples); effect > kFaintest) {
      size = std::min(kTermEffect / effect, kStrongest);
    }
  }
}

}  // namespace armcmc
