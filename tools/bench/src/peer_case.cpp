#include "armcmc/bench/peer_case.hpp"

#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "armcmc/adjust_result.hpp"
#include "armcmc/bench/press.hpp"
#include "armcmc/estimator.hpp"

namespace armcmc::bench {
namespace {

constexpr int kSamples = 100;

/// Normal law of (K, B) given p, and the log density of p, up to a constant.
struct Conditional {
  std::array<double, 2> mean, variance;
  double log_density = 0.0;
};

Conditional GivenExponent(const PeerCase& what, double p) {
  const auto& prior = what.settings.parameters;
  const double precision = 1.0 / (what.settings.noise[0].std * what.settings.noise[0].std);
  // Residuals are taken about the prior mean, with which the prior has no linear term.
  const double k0 = prior[0].mean, b0 = prior[1].mean;
  double a = 1.0 / (prior[0].sd * prior[0].sd), b = 0.0, c = 1.0 / (prior[1].sd * prior[1].sd);
  double rk = 0.0, rb = 0.0, rr = 0.0;
  for (int n = 0; n < what.pack.num_samples; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const double h = std::pow(what.pack.u[i][0], p), hv = h * what.pack.u[i][1];
    const double r = what.pack.y[i] - k0 * h - b0 * hv;
    a += precision * h * h;
    b += precision * h * hv;
    c += precision * hv * hv;
    rk += precision * h * r;
    rb += precision * hv * r;
    rr += precision * r * r;
  }
  const double det = a * c - b * b;
  const double dk = (c * rk - b * rb) / det, db = (a * rb - b * rk) / det;
  const double z = (p - prior[2].mean) / prior[2].sd;
  Conditional given;
  given.mean = {k0 + dk, b0 + db};
  given.variance = {c / det, a / det};
  given.log_density = -0.5 * (rr - dk * rk - db * rb + std::log(det) + z * z);
  return given;
}

/// The same with the sums over nodes from low to high.
std::array<Moments, 3> Sum(const PeerCase& what, double low, double high) {
  constexpr int kNodes = 4001;
  std::vector<Conditional> nodes;
  double top = -HUGE_VAL;
  const auto node = [&](int i) { return low + (high - low) * i / (kNodes - 1); };
  for (int i = 0; i < kNodes; ++i) {
    nodes.push_back(GivenExponent(what, node(i)));
    top = std::fmax(top, nodes.back().log_density);
  }
  double total = 0.0;
  std::array<double, 3> mean{}, variance{};
  const auto values = [&](int i) {
    const Conditional& c = nodes[static_cast<std::size_t>(i)];
    return std::array{c.mean[0], c.mean[1], node(i)};
  };
  const auto weight = [&](int i) { return std::exp(nodes[static_cast<std::size_t>(i)].log_density - top); };
  for (int i = 0; i < kNodes; ++i) {
    total += weight(i);
    for (std::size_t d = 0; d < 3; ++d) mean[d] += weight(i) * values(i)[d];
  }
  for (double& m : mean) m /= total;
  for (int i = 0; i < kNodes; ++i)
    for (std::size_t d = 0; d < 3; ++d) {
      const double e = values(i)[d] - mean[d];
      const double given = d < 2 ? nodes[static_cast<std::size_t>(i)].variance[d] : 0.0;
      variance[d] += weight(i) * (e * e + given) / total;
    }
  std::array<Moments, 3> moments;
  for (std::size_t d = 0; d < 3; ++d) moments[d] = {mean[d], std::sqrt(variance[d])};
  return moments;
}

std::ofstream Open(const std::filesystem::path& path) {
  std::ofstream file(path);
  if (!file) throw std::runtime_error("cannot write " + path.string());
  file.precision(17);
  return file;
}

void Close(std::ofstream* file, const std::filesystem::path& path) {
  file->close();
  if (!*file) throw std::runtime_error("cannot write " + path.string());
}

/// Whole steps (adjust and execute) of new estimators, which differ in the seed of their draws.
void WriteReplicates(const PeerCase& what, int replicates, const std::filesystem::path& folder) {
  const std::filesystem::path weighted_path = folder / "armcmc_weighted.csv", chain_path = folder / "armcmc_chain.csv";
  std::ofstream weighted = Open(weighted_path), chain = Open(chain_path);
  const std::string set(InstructionSet());
  weighted << "# peer: armcmc (" << set << "), published mean\n# how: as shipped; all draws by their weights, control "
           << "variates\nms,acceptance,evaluations,K,B,p\n";
  chain << "# peer: armcmc (" << set << "), mean of the chain\n# how: the same step; the mean of the chain alone\n"
        << "ms,acceptance,evaluations,K,B,p\n";
  EstimatorSettings settings = what.settings;
  Estimate estimate;
  for (int r = 0; r < replicates; ++r) {
    settings.sampler.seed = 1000 + static_cast<std::uint64_t>(r);
    Estimator estimator(settings);
    const auto result = estimator.MakeResult();
    const auto start = std::chrono::steady_clock::now();
    const Status status = estimator.Adjust(what.pack, std::numeric_limits<Nanos>::max(), ClockRef(), result.get());
    estimator.Execute(*result, &estimate);
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
    if (status != Status::kOk) throw std::runtime_error(what.name + ": the estimator refuses the pack");
    const ModeEstimate& mode = estimate.modes[0];
    for (const auto& [file, of] :
         {std::pair{&weighted, &MarginalSummary::ar_ap}, std::pair{&chain, &MarginalSummary::chain_mean}}) {
      *file << ms.count() << ',' << mode.acceptance << ',' << mode.draws;
      for (std::size_t d = 0; d < 3; ++d) *file << ',' << mode.marginal[d].*of;
      *file << '\n';
    }
  }
  Close(&weighted, weighted_path);
  Close(&chain, chain_path);
}

}  // namespace

std::vector<PeerCase> PeerCases() {
  Press rich, poor;
  poor.depth = 0.4;
  poor.stroke = 0.02;
  std::vector<PeerCase> cases;
  for (const auto& [name, press] : {std::pair{"cold", rich}, std::pair{"ridge", poor}}) {
    PeerCase what{name, BuiltinSettings(PressedPlant()), MakePress(press, 0, kSamples, 7)};
    what.settings.noise[0].std = press.noise;
    cases.push_back(what);
  }
  return cases;
}

std::array<Moments, 3> QuadraturePosterior(const PeerCase& what) {
  constexpr int kRounds = 8;
  constexpr double kReach = 12.0, kClear = 6.0;
  const auto& prior = what.settings.parameters;
  for (std::size_t d = 0; d < 3; ++d)
    if (prior[d].prior != PriorKind::kNormal) throw std::invalid_argument(prior[d].name + ": its prior is not normal");
  std::array<Moments, 3> moments = Sum(what, prior[2].lower, prior[2].upper);
  // Nodes that are too far apart at first: their spread is never taken for less than their distance.
  double distance = (prior[2].upper - prior[2].lower) / 4000.0;
  for (int round = 0; round < kRounds; ++round) {
    const double reach = kReach * std::fmax(moments[2].sd, distance);
    moments = Sum(what, moments[2].mean - reach, moments[2].mean + reach);
    distance = 2.0 * reach / 4000.0;
  }
  for (std::size_t d = 0; d < 3; ++d) {
    const Moments& m = moments[d];
    if (m.mean - kClear * m.sd < prior[d].lower || m.mean + kClear * m.sd > prior[d].upper)
      throw std::invalid_argument(prior[d].name + ": a bound of its prior cuts the posterior");
  }
  return moments;
}

void WritePeerCases(const std::filesystem::path& folder, int replicates) {
  for (const PeerCase& what : PeerCases()) {
    std::filesystem::create_directories(folder / what.name);
    const std::filesystem::path pack = folder / what.name / "pack.csv";
    std::ofstream rows = Open(pack);
    rows << "x,v,f,noise_sd\n";
    for (int n = 0; n < what.pack.num_samples; ++n) {
      const auto i = static_cast<std::size_t>(n);
      rows << what.pack.u[i][0] << ',' << what.pack.u[i][1] << ',' << what.pack.y[i] << ','
           << what.settings.noise[0].std << '\n';
    }
    Close(&rows, pack);
    const std::filesystem::path parameters = folder / what.name / "parameters.csv";
    const std::array<Moments, 3> posterior = QuadraturePosterior(what);
    std::ofstream table = Open(parameters);
    table << "name,mean,sd,lower,upper,posterior_mean,posterior_sd\n";
    for (std::size_t d = 0; d < 3; ++d) {
      const ParameterSettings& p = what.settings.parameters[d];
      table << p.name << ',' << p.mean << ',' << p.sd << ',' << p.lower << ',' << p.upper << ',' << posterior[d].mean
            << ',' << posterior[d].sd << '\n';
    }
    Close(&table, parameters);
    WriteReplicates(what, replicates, folder / what.name);
  }
}

}  // namespace armcmc::bench
