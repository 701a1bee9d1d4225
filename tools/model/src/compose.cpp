#include "compose.hpp"

#include <fstream>

#include "armcmc/support/csv.hpp"
#include "armcmc/support/plant_library.hpp"
#include "armcmc/support/plant_writer.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::model {
namespace {

DataScales ScalesOf(const PlantDescription& plant, const std::filesystem::path& data) {
  support::CsvRequest request;
  request.columns = {"t"};
  for (const SignalDescription& signal : plant.signals) {
    request.columns.push_back(signal.name);
    if (!signal.derivative_of.empty()) request.derived.push_back({signal.name, signal.derivative_of});
  }
  support::CsvSamples samples = support::ReadCsv(data, request);
  const std::vector<double> times = std::move(samples.columns.front());
  samples.columns.erase(samples.columns.begin());
  if (times.size() < 2) throw support::InputError(data.string() + ": expected at least two rows");
  return MeasuredScales(plant, samples.columns, times);
}

}  // namespace

PlantDescription Composed(const support::PlantFile& plant, const std::vector<std::string>& words,
                          const std::optional<std::filesystem::path>& data) {
  std::vector<support::EffectRequest> requests;
  for (const std::string& word : words) requests.push_back(support::RequestFromWord(word));
  const PlantDescription& base = plant.plant.description();
  std::optional<DataScales> scales;
  if (data) scales = ScalesOf(base, *data);
  return support::WithEffects(base, support::EffectsFor(plant.effects), requests, scales ? &*scales : nullptr, "");
}

std::string AddToFile(const std::string& plant, const std::string& effect,
                      const std::optional<std::filesystem::path>& data, const std::filesystem::path& out) {
  const support::PlantFile read = support::ReadPlantFile(support::FindPlantFile(plant));
  const PlantDescription composed = Composed(read, {effect}, data);
  if (std::filesystem::exists(out)) throw support::InputError(out.string() + ": already exists");
  const std::string sizes = data ? "sizes of its priors from " + data->string()
                                 : std::string("sizes of its priors are guesses, without data");
  std::ofstream file(out, std::ios::binary);
  file << support::PlantFileText(composed, plant + " with " + effect + "; " + sizes);
  if (!file.flush()) throw support::InputError(out.string() + ": cannot be written");
  std::string added;
  for (std::size_t p = read.plant.description().parameters.size(); p < composed.parameters.size(); ++p)
    added += (added.empty() ? "" : ", ") + composed.parameters[p].name;
  return out.string() + ": " + plant + " with " + effect + ", parameters added: " + added + "; " + sizes + '\n';
}

}  // namespace armcmc::model
