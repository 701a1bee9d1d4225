#include "armcmc/tables/recording.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include "armcmc/support/csv.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/subprocess.hpp"
#include "armcmc/tables/plants/registry.hpp"

namespace armcmc::tables {
namespace {

constexpr std::array<double, 3> kPaperContact{4.0, 2.3, 1.7};

std::vector<std::string> Header(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line) && (line.empty() || line[0] == '#')) {
  }
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> names;
  std::size_t from = 0;
  while (from <= line.size()) {
    const std::size_t end = std::min(line.find(',', from), line.size());
    names.push_back(line.substr(from, end - from));
    from = end + 1;
  }
  return names;
}

bool Has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

Recording ReadRecording(const std::filesystem::path& path, PlantNumber plant, double p_atm) {
  const bool contact = kContact.Is(plant);
  const std::vector<std::string> names = Header(path);
  support::CsvRequest request;
  request.columns = contact ? std::vector<std::string>{"t", "x", "v", "f", "f_true"}
                            : std::vector<std::string>{"t", "u_c", "u_d", "p", "pdot", "alpha", "flow"};
  const bool with_truth = Has(names, contact ? "K_true" : "g_true");
  const bool with_theta1 = Has(names, "theta1_true");
  if (!contact && !with_truth && !with_theta1)
    throw support::InputError(path.string() + ": needs a column g_true or theta1_true");
  if (contact && with_truth) request.columns.insert(request.columns.end(), {"K_true", "B_true", "p_true"});
  if (!contact) request.columns.insert(request.columns.end(), {with_truth ? "g_true" : "theta1_true", "theta2_true"});
  support::CsvSamples samples = support::ReadCsv(path, request);
  auto& c = samples.columns;
  Recording r;
  r.name = path.stem().string();
  r.plant = plant;
  if (samples.num_rows() < 2) throw support::InputError(path.string() + ": holds no samples");
  r.dt = (c[0].back() - c[0].front()) / static_cast<double>(samples.num_rows() - 1);
  if (contact) {
    r.u[0] = c[1];
    r.u[1] = c[2];
    r.y = c[3];
    r.target = c[4];
    for (std::size_t d = 0; d < 3; ++d)
      r.truth[d] = with_truth ? c[5 + d] : std::vector<double>(samples.num_rows(), kPaperContact[d]);
    return r;
  }
  for (std::size_t i = 0; i < 4; ++i) r.u[i] = c[1 + i];
  r.y = c[5];
  r.target = c[6];
  r.truth[0] = c[7];
  r.truth[1] = c[8];
  if (!with_truth)
    for (std::size_t i = 0; i < r.size(); ++i) r.truth[0][i] += r.truth[1][i] * p_atm;
  return r;
}

void FillPack(const Recording& recording, int k, int samples, DataPack* pack) {
  *pack = DataPack{};
  pack->seq = k;
  pack->run_id = 1;
  pack->dt = recording.dt;
  pack->plant = recording.plant;
  pack->num_samples = samples;
  pack->num_inputs = kContact.Is(recording.plant) ? 2 : 4;
  for (std::size_t n = 0; n < static_cast<std::size_t>(samples); ++n) {
    const std::size_t row = static_cast<std::size_t>(samples * (k - 1)) + 1 + n;
    pack->y[n] = recording.y[row];
    for (std::size_t i = 0; i < static_cast<std::size_t>(pack->num_inputs); ++i) pack->u[n][i] = recording.u[i][row];
    pack->t_last_s = static_cast<double>(row) * recording.dt;
  }
}

std::filesystem::path Simulate(const std::string& scenario, std::uint64_t seed, const std::filesystem::path& folder) {
  const std::filesystem::path program = support::SiblingProgram("armcmc-plant");
  const std::filesystem::path csv =
      std::filesystem::absolute(folder) / (scenario + "-" + std::to_string(seed) + ".csv");
  const support::SubprocessEnd end = support::RunSubprocess(
      program, {"--scenario", scenario, "--seed", std::to_string(seed), "--csv", csv.string()}, folder);
  if (end.code != 0) throw std::runtime_error(program.string() + " --scenario " + scenario + " failed: " + end.errors);
  return csv;
}

}  // namespace armcmc::tables
