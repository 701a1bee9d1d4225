#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>

#include "armcmc/calibrate/calibrate.hpp"
#include "armcmc/calibrate/config_text.hpp"
#include "armcmc/calibrate/report.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/progress.hpp"
#include "runs.hpp"
#include "session.hpp"

namespace armcmc::replay {
namespace {

std::string TextOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

bool SameNoise(const NoiseSettings& a, const NoiseSettings& b) {
  return a.kind == b.kind && a.std == b.std && a.mean == b.mean && (a.kind != NoiseKind::kStudentT || a.dof == b.dof) &&
         (a.kind != NoiseKind::kMixture ||
          (a.outlier_weight == b.outlier_weight && a.outlier_scale == b.outlier_scale));
}

/// What was written must read back as what was found: a configuration may be laid out in ways that we did not expect,
/// and a model file has the last word on noise.
void RequireReadsBack(const Arguments& a, const EstimatorSettings& wanted, int num_modes) {
  const EstimatorSettings read = ReadSession(a.calibrate, a.model, a.seed).settings;
  bool same = read.forgetting.threshold == wanted.forgetting.threshold && read.forgetting.rho == wanted.forgetting.rho;
  for (std::size_t mode = 0; mode < static_cast<std::size_t>(num_modes); ++mode)
    same = same && SameNoise(read.noise[mode], wanted.noise[mode]);
  if (!same)
    throw std::runtime_error(a.calibrate + ": does not read back as what was found; " +
                             (a.model.empty() ? "give [noise] and [forgetting] of " + a.config + " headers of their own"
                                              : "the noise of " + a.model + " replaces that of a configuration"));
}

}  // namespace

int RunCalibration(const Arguments& a) {
  const Session session = ReadSession(a.config, a.model, a.seed);
  const Estimator estimator(session.settings);
  SourceRequest source = RequestFor(a, session, estimator);
  source.repeat_draws = false;
  source.one_recursion = true;

  calibrate::CalibrationRequest request;
  request.settings = session.settings;
  request.false_modifications = a.false_modifications;
  request.open = [&source] { return OpenSource(source); };
  calibrate::Calibration found;
  {
    support::Progress progress("calibrate");
    request.on_progress = [&progress](double share) { progress.Update(share); };
    found = calibrate::Calibrate(request);
  }
  std::ofstream config = OpenOutput(a.calibrate);
  config << calibrate::CalibratedConfig(TextOf(session.config), found.settings, source.mode_names);
  Close(&config, a.calibrate);
  RequireReadsBack(a, found.settings, estimator.num_modes());

  const std::string unit(estimator.target_unit());
  const std::string page = std::filesystem::path(a.calibrate).replace_extension(".html").string();
  std::ofstream report = OpenOutput(page);
  report << calibrate::ReportHtml(found, a.data, a.config, unit);
  Close(&report, page);
  std::cout << calibrate::SummaryText(found, unit) << "configuration: " << a.calibrate << "\nreport: " << page << '\n';
  return support::kExitOk;
}

}  // namespace armcmc::replay
