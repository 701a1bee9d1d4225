#include "armcmc/calibrate/config_text.hpp"

#include <sstream>
#include <string_view>

#include "armcmc/calibrate/noise_fit.hpp"
#include "armcmc/support/csv.hpp"

namespace armcmc::calibrate {
namespace {

/// "forgetting" for "[forgetting]   # when"; empty for a line that is no header.
std::string HeaderOf(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos || line[begin] != '[') return "";
  const std::size_t end = line.find(']', begin);
  if (end == std::string_view::npos) return "";
  return std::string(line.substr(begin + 1, end - begin - 1));
}

/// "threshold" for "threshold = 1.0   # mismatch".
std::string KeyOf(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t"), equals = line.find('=');
  if (begin == std::string_view::npos || equals == std::string_view::npos || line[begin] == '#') return "";
  const std::size_t end = line.find_last_not_of(" \t", equals - 1);
  return std::string(line.substr(begin, end + 1 - begin));
}

void WriteNoise(const NoiseSettings& noise, const std::string& table, std::ostream* out) {
  using support::ExactNumber;
  *out << "[" << table << "]\nkind = \"" << Name(noise.kind) << "\"\nstd = " << ExactNumber(noise.std)
       << "\nmean = " << ExactNumber(noise.mean) << "\nestimate_std = " << (noise.estimate_std ? "true" : "false")
       << "\nstd_log_sd = " << ExactNumber(noise.std_log_sd) << "\n";
  if (noise.kind == NoiseKind::kStudentT) *out << "dof = " << ExactNumber(noise.dof) << "\n";
  if (noise.kind == NoiseKind::kMixture)
    *out << "outlier_weight = " << ExactNumber(noise.outlier_weight)
         << "\noutlier_scale = " << ExactNumber(noise.outlier_scale) << "\n";
  *out << "\n";
}

void WriteForgetting(const ForgettingSettings& forgetting, std::ostream* out) {
  *out << "threshold = " << support::ExactNumber(forgetting.threshold) << "   # calibrated\n"
       << "rho = " << support::ExactNumber(forgetting.rho) << "   # calibrated: 0 weighs all samples of a pack alike\n";
}

}  // namespace

std::string CalibratedConfig(const std::string& text, const EstimatorSettings& settings,
                             const std::vector<std::string>& mode_names) {
  std::istringstream in(text);
  std::ostringstream out;
  std::string table;
  bool forgetting = false;
  for (std::string line; std::getline(in, line);) {
    if (const std::string header = HeaderOf(line); !header.empty()) table = header;
    if (table == "noise" || table.starts_with("noise.")) continue;
    if (table == "forgetting" && (KeyOf(line) == "threshold" || KeyOf(line) == "rho")) continue;
    out << line << '\n';
    if (HeaderOf(line) != "forgetting") continue;
    forgetting = true;
    WriteForgetting(settings.forgetting, &out);
  }
  if (!forgetting) {
    out << "\n[forgetting]\n";
    WriteForgetting(settings.forgetting, &out);
  }
  out << "\n# Calibrated from a recording of normal operation.\n";
  if (mode_names.size() == 1) {
    WriteNoise(settings.noise[0], "noise", &out);
  } else {
    for (std::size_t mode = 0; mode < mode_names.size(); ++mode)
      WriteNoise(settings.noise[mode], "noise." + mode_names[mode], &out);
  }
  return out.str();
}

}  // namespace armcmc::calibrate
