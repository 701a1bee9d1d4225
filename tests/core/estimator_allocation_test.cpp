#include <gtest/gtest.h>

#include <iterator>
#include <vector>

#include "core/estimator_rig.hpp"
#include "core/plant/plants.hpp"
#include "support/alloc_counter.hpp"

namespace armcmc::estimator_allocation_test {
namespace {

using test::AllocCounter;
using test::Rig;

/// Heap calls, frees included, of adjusting and executing all packs.
long CountHeapCalls(const EstimatorSettings& settings, const std::vector<DataPack>& packs) {
  Rig rig(settings);
  const AllocCounter guard;
  for (const DataPack& pack : packs) rig.Step(pack);
  rig.estimator.Reset();
  for (const DataPack& pack : packs) rig.Step(pack);
  return guard.count() + guard.frees();
}

constexpr NoiseKind kKinds[] = {NoiseKind::kGaussian, NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture};

/// First pack, reinforcement, an abrupt change, free motion, too few samples, a bad pack, a hopeless one.
std::vector<DataPack> ContactPacks() {
  std::vector<DataPack> packs;
  for (std::int64_t seq = 10; seq <= 13; ++seq) packs.push_back(test::Contact{}.Pack(seq));
  packs.push_back(test::Contact{.k = 8.0, .b = 0.5}.Pack(14));
  packs.push_back(test::Contact{}.Pack(test::kFreePack));
  packs.push_back(packs[0]);
  packs.back().num_samples = 2;
  packs.push_back(packs[0]);
  packs.back().num_samples = 0;
  packs.push_back(packs[0]);
  packs.back().y.fill(1e200);
  packs.push_back(test::Contact{}.Pack(15));
  return packs;
}

std::vector<DataPack> ActuatorPacks() {
  std::vector<DataPack> packs;
  for (std::int64_t seq = 1; seq <= 3; ++seq) packs.push_back(test::Actuator{}.Pack(seq, 100));
  packs.push_back(test::Actuator{}.Pack(4, 50));
  packs.push_back(test::Actuator{}.Pack(6, 0));  // a gap
  return packs;
}

TEST(Allocation, ContactStepsDoNotTouchTheHeap) {
  if (!AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  constexpr MismatchIndex kIndices[] = {MismatchIndex::kSignedMean, MismatchIndex::kRms, MismatchIndex::kLogPredictive};
  std::size_t turn = 0;  // every index and every law, not every pair of them
  for (const NoiseKind kind : kKinds)
    for (const bool estimate_std : {false, true}) {
      EstimatorSettings settings = BuiltinSettings("hunt_crossley");
      settings.noise[0].kind = kind;
      settings.noise[0].estimate_std = estimate_std;
      settings.forgetting.index = kIndices[turn++ % std::size(kIndices)];
      settings.forgetting.rho = 0.01;
      EXPECT_EQ(CountHeapCalls(settings, ContactPacks()), 0) << static_cast<int>(kind) << estimate_std;
    }
}

TEST(Allocation, ActuatorStepsDoNotTouchTheHeap) {
  if (!AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  for (const NoiseKind kind : kKinds)
    for (const bool estimate_std : {false, true}) {
      EstimatorSettings settings = test::ActuatorSettings();
      for (NoiseSettings& noise : settings.noise) {
        noise.kind = kind;
        noise.estimate_std = estimate_std;
      }
      EXPECT_EQ(CountHeapCalls(settings, ActuatorPacks()), 0) << static_cast<int>(kind) << estimate_std;
    }
}

TEST(Allocation, ConstructionDoes) {
  if (!AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  const AllocCounter guard;
  const Rig rig;
  EXPECT_GT(guard.count(), 10) << "the counter sees this library";
}

/// Of a described plant, under every law of the noise.
void ExpectNoHeapCalls(const PlantDescription& description, std::vector<DataPack> packs) {
  const auto plant = test::Program(description);
  for (DataPack& pack : packs) {
    pack.plant = PlantNumber::kDescribed;
    pack.fingerprint = plant->plant().fingerprint();
  }
  for (const NoiseKind kind : kKinds) {
    EstimatorSettings settings = DescribedSettings(plant);
    for (NoiseSettings& noise : settings.noise) noise.kind = kind;
    EXPECT_EQ(CountHeapCalls(settings, packs), 0) << description.name << ", noise " << static_cast<int>(kind);
  }
}

TEST(Allocation, StepsOfADescribedPlantDoNotTouchTheHeap) {
  if (!AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  // Functions with memory, a lognormal parameter, a quantity that is computed from them, a law without a loop of its
  // own.
  PlantDescription description = test::DescribedContact();
  description.parameters[0] = {"K", "N/m^p", "lognormal", 2.5, 1.0};
  description.modes[0].law = "x^p * (K + B*lowpass(v, 0.01)) + K*x*tanh(delay(v, 0.02)/g)";
  description.constants = {{"g", 1.0, ""}};
  description.reports = {{"KB", "1", "K*B"}};
  ExpectNoHeapCalls(description, ContactPacks());
}

TEST(Allocation, StepsOfAPlantWithStatesDoNotTouchTheHeap) {
  if (!AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  PlantDescription description = test::DescribedContact();
  description.constants = {{"c", 0.01, "1/s"}};
  description.modes[0].law = "place^p * (K + B*v)";
  description.states = {{"place", "m", "position", "v + c*(x - place)", "x", "", 2}};
  ExpectNoHeapCalls(description, ContactPacks());
}

TEST(Allocation, StepsOfAPlantThatIsSimulatedBesideItsLawsDoNotTouchTheHeap) {
  if (!AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  ExpectNoHeapCalls(test::DescribedVessel(), ContactPacks());
}

}  // namespace
}  // namespace armcmc::estimator_allocation_test
