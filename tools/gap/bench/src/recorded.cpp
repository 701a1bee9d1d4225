#include "recorded.hpp"

#include <algorithm>
#include <armcmc/support/csv.hpp>
#include <armcmc/support/program.hpp>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <random>
#include <utility>

#include "armcmc/gap_bench/scenario_text.hpp"
#include "armcmc/gap_bench/strata.hpp"
#include "recorded_source.hpp"

namespace armcmc::gap_bench {
namespace {

const std::vector<std::string> kOwn = {"periodic_disturbance"};  // in the noise of the sensor

constexpr double kInterval = 1e-3, kDuration = 20.0;  // s
constexpr double kFree = 0.25;                        // share of the depth that a motion rises above the surface

struct Samples {
  std::vector<double> t, value;
};

Samples Read(const std::filesystem::path& folder, const RecordedSource& source) {
  support::CsvRequest request;
  request.columns = {source.time};
  for (const auto& column : source.columns) request.columns.push_back(column.first);
  request.until = source.until_s / source.second;
  const support::CsvSamples samples = support::ReadCsv(folder / source.file, request);
  Samples read;
  for (std::size_t i = 0; i < samples.num_rows(); ++i) {
    double sum = 0.0;
    for (std::size_t c = 0; c < source.columns.size(); ++c) sum += source.columns[c].second * samples.columns[c + 1][i];
    read.t.push_back(source.second * samples.columns[0][i]);
    read.value.push_back(sum);
  }
  if (read.t.size() < 2) throw support::InputError((folder / source.file).string() + ": holds no samples");
  return read;
}

/// On an even grid, from t = 0.
Samples Even(const Samples& samples, double interval) {
  Samples even;
  std::size_t at = 0;
  const auto rows = static_cast<std::size_t>((samples.t.back() - samples.t.front()) / interval) + 1;
  for (std::size_t i = 0; i < rows; ++i) {
    const double t = static_cast<double>(i) * interval;
    while (at + 2 < samples.t.size() && samples.t[at + 1] - samples.t.front() < t) ++at;
    const double share = (t + samples.t.front() - samples.t[at]) / (samples.t[at + 1] - samples.t[at]);
    even.t.push_back(t);
    even.value.push_back(std::lerp(samples.value[at], samples.value[at + 1], std::clamp(share, 0.0, 1.0)));
  }
  return even;
}

/// From free motion to the deepest press, in units of the depth.
void PressToDepth(std::vector<double>* x) {
  const auto [low, high] = std::minmax_element(x->begin(), x->end());
  const double from = *low, range = *high - *low;
  for (double& value : *x) value = -kFree + (1.0 + kFree) * (value - from) / range;
}

/// Takes a straight line off.
void Detrend(std::vector<double>* e) {
  const auto n = static_cast<double>(e->size());
  double sum = 0.0, moment = 0.0;
  for (std::size_t i = 0; i < e->size(); ++i) {
    sum += (*e)[i];
    moment += (static_cast<double>(i) - 0.5 * (n - 1.0)) * (*e)[i];
  }
  const double slope = 12.0 * moment / (n * (n * n - 1.0));
  for (std::size_t i = 0; i < e->size(); ++i) (*e)[i] -= sum / n + slope * (static_cast<double>(i) - 0.5 * (n - 1.0));
}

/// @return its path.
std::filesystem::path Write(const std::filesystem::path& folder, const std::string& name, const std::string& column,
                            const Samples& samples) {
  std::filesystem::path path = std::filesystem::absolute(folder / "scenarios" / (name + ".csv"));
  std::filesystem::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  file << "t," << column << '\n';
  for (std::size_t i = 0; i < samples.t.size(); ++i)
    file << support::ExactNumber(samples.t[i]) << ',' << support::ExactNumber(samples.value[i]) << '\n';
  if (!file.flush()) throw support::InputError(path.string() + ": cannot be written");
  return path;
}

/// @param noise  Empty: that of the scenario which comes with the plant.
std::string Scenario(const std::filesystem::path& motion, double start_s, const std::filesystem::path& noise) {
  std::string text = WithTable(ScenarioOfPlant("contact_rich"), "motion",
                               "tracking = \"prescribed\"\nprogram = \"recorded\"\nrecording = \"" + motion.string() +
                                   "\"\nrecording_start_s = " + Short(start_s) + "\ndepth = 0.3\n");
  if (!noise.empty())
    text =
        WithTable(text, "noise.f", "kind = \"recorded\"\nrecording = \"" + noise.string() + "\"\nstd_share = 0.01\n");
  const std::string old = "duration_s = 10.0";
  return text.replace(text.find(old), old.size(), "duration_s = " + Short(kDuration) + ".0");
}

}  // namespace

void AddRecorded(const std::filesystem::path& recordings, const std::vector<std::string>& effects,
                 CaseBuilder* builder) {
  if (recordings.empty()) throw support::InputError("the stratum recorded needs --recordings, a folder");
  const RecordedSources sources = ReadRecordedSources();
  Samples noise = Read(recordings, sources.noise);
  Detrend(&noise.value);
  for (std::size_t i = 0; i < noise.t.size(); ++i) noise.t[i] = static_cast<double>(i) * kInterval;
  const std::filesystem::path noise_file = Write(builder->folder(), sources.noise.name, "e", noise);
  std::vector<std::string> hidden = {"none"};
  hidden.insert(hidden.end(), effects.begin(), effects.end());
  for (const RecordedSource& source : sources.motions) {
    Samples motion = Even(Read(recordings, source), kInterval);
    PressToDepth(&motion.value);
    const std::filesystem::path file = Write(builder->folder(), source.name, "x", motion);
    const double spare = std::max(motion.t.back() - kDuration, 0.0);
    for (const std::string& effect : hidden) {
      Case like = Like("real motion", "", effect, 1.0);
      for (const bool real_noise : {false, true}) {
        if (real_noise) {
          like.group = kRealNoise;
          like.own = kOwn;
        }
        builder->Cell(like, source.name + "/" + effect, [&](Case* one, std::mt19937_64* random) {
          const double start_s = spare * 1e-3 * static_cast<double>((*random)() % 1001);
          one->scenario = builder->Write(source.name + "_" + std::to_string(one->seed),
                                         Scenario(file, start_s, real_noise ? noise_file : std::filesystem::path()));
          if (real_noise) return;
          for (const Part part : {Part::kFirstHalf, Part::kSecondHalf}) {
            Case half = *one;
            half.group = "real motion, halves";
            half.part = part;
            // What has drifted before the second half began is a bias of it.
            if (part == Part::kSecondHalf && effect.starts_with("force_drift")) half.own = {"force_bias"};
            builder->Add(std::move(half));
          }
        });
      }
    }
  }
}

}  // namespace armcmc::gap_bench
