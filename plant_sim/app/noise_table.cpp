#include "noise_table.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/plant_sim/rng.hpp"
#include "series_file.hpp"

namespace armcmc::plant_sim {
namespace {

using support::StrictTable;

// With the channel's index added, streams of the seed that nothing else uses.
constexpr std::uint64_t kCorrelationStream = 0xd2'00;

/// Column e of a file, without its mean and in units of its standard deviation.
std::shared_ptr<const Series> ReadRecordedNoise(StrictTable* table, const std::filesystem::path& file) {
  for (const char* key : {"correlation", "correlation_to"})
    if (table->Has(key)) throw table->Error(key, "cannot be chosen: recorded noise has its own correlation");
  Series noise = *ReadSeries(table->RequiredText("recording"), file, "e");
  const auto count = static_cast<double>(noise.values.size());
  const double mean = std::accumulate(noise.values.begin(), noise.values.end(), 0.0) / count;
  double squares = 0.0;
  for (double& value : noise.values) {
    value -= mean;
    squares += value * value;
  }
  if (!(squares > 0.0)) throw table->Error("recording", "is constant: it holds no noise");
  for (double& value : noise.values) value /= std::sqrt(squares / count);
  return std::make_shared<const Series>(std::move(noise));
}

NoiseLaw ReadLaw(StrictTable table, double share_of_range, const std::filesystem::path& file) {
  NoiseLaw law;
  const std::string kind = table.RequiredChoice("kind", {"gaussian", "student_t", "laplace", "mixture", "recorded"});
  if (table.Has("std_share")) {
    if (table.Has("std")) throw table.Error("std_share", "contradicts std: a channel has one level");
    law.share = table.RequiredNumber("std_share", 1e-9, 1e3);
  } else {
    law.std = table.RequiredNumber("std", 0.0, 1e9);
  }
  if (kind == "gaussian") law.kind = NoiseKind::kGaussian;
  if (kind == "laplace") law.kind = NoiseKind::kLaplace;
  if (kind == "student_t") {
    law.kind = NoiseKind::kStudentT;
    law.dof = table.Number("dof", law.dof, 0.5, 1e6);
  }
  if (kind == "mixture") {
    law.kind = NoiseKind::kMixture;
    law.outlier_weight = table.Number("outlier_weight", law.outlier_weight, 1e-6, 0.5);
    law.outlier_scale = table.Number("outlier_scale", law.outlier_scale, 1.0, 1e6);
  }
  if (kind == "recorded") {
    law.kind = NoiseKind::kRecorded;
    law.recording = ReadRecordedNoise(&table, file);
  }
  constexpr double kMaxCorrelation = 0.99;
  law.correlation = table.Number("correlation", 0.0, 0.0, kMaxCorrelation);
  const double upper = table.Number("correlation_to", law.correlation, law.correlation, kMaxCorrelation);
  law.correlation += share_of_range * (upper - law.correlation);
  law.growth = table.Number("growth", 0.0, 0.0, 100.0);
  return law;
}

std::vector<std::string> ChannelNames(const PlantFamily& family) {
  std::vector<std::string> names;
  for (const ChannelSpec& channel : family.inputs) names.push_back(channel.name);
  names.push_back(family.output.name);
  return names;
}

double Channel(const PlantSample& sample, std::size_t channel, std::size_t num_inputs) {
  return channel < num_inputs ? sample.inputs[channel] : sample.output;
}

/// Rms of every channel over the samples in which a mode acts, of at most the first 200 000.
std::vector<double> Rms(const Scenario& scenario) {
  constexpr long long kMaxSamples = 200'000;
  const auto num_inputs = static_cast<std::size_t>(scenario.family->num_inputs());
  const std::unique_ptr<Plant> plant = scenario.MakePlant();
  std::vector<double> sum(num_inputs + 1);
  long long acting = 0;
  const long long last = std::min(scenario.last_sample(scenario.num_packs()), kMaxSamples);
  for (long long i = 0; i <= last; ++i) {
    PlantSample sample;
    plant->Advance(&sample);
    if (sample.mode >= scenario.family->num_modes()) continue;
    ++acting;
    for (std::size_t c = 0; c < sum.size(); ++c) {
      const double value = Channel(sample, c, num_inputs);
      sum[c] += value * value;
    }
  }
  for (double& value : sum) value = acting > 0 ? std::sqrt(value / static_cast<double>(acting)) : 0.0;
  return sum;
}

}  // namespace

std::vector<NoiseLaw> ReadNoise(StrictTable table, const PlantFamily& family, std::uint64_t seed,
                                const std::filesystem::path& file) {
  std::vector<NoiseLaw> laws;
  for (const std::string& channel : ChannelNames(family)) {
    Rng rng(seed, kCorrelationStream + laws.size());
    laws.push_back(table.Has(channel) ? ReadLaw(table.Table(channel), rng.Uniform(), file) : NoiseLaw{});
  }
  return laws;
}

void ResolveNoise(Scenario* scenario) {
  const auto relative = [](const NoiseLaw& law) { return law.share > 0.0 || law.growth > 0.0; };
  if (std::none_of(scenario->noise.begin(), scenario->noise.end(), relative)) return;
  const std::vector<double> rms = Rms(*scenario);
  for (std::size_t c = 0; c < rms.size(); ++c) {
    NoiseLaw& law = scenario->noise[c];
    if (!relative(law)) continue;
    if (!(rms[c] > 0.0) || !std::isfinite(rms[c])) {
      const std::string name = ChannelNames(*scenario->family)[c];
      throw std::invalid_argument("noise." + name + (law.share > 0.0 ? ".std_share" : ".growth") +
                                  " refers to the rms of " + name +
                                  " while in contact, which this motion leaves at zero: give std");
    }
    law.reference = rms[c];
    if (law.share > 0.0) law.std = law.share * law.reference;
  }
}

}  // namespace armcmc::plant_sim
