#include <fstream>
#include <iostream>
#include <optional>
#include <string>

#include "armcmc/replay/estimate_csv.hpp"
#include "armcmc/replay/prediction_csv.hpp"
#include "armcmc/replay/replay.hpp"
#include "armcmc/replay/verify.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/progress.hpp"
#include "report.hpp"
#include "runs.hpp"
#include "session.hpp"
#include "step_check.hpp"

namespace armcmc::replay {

int RunEstimates(const Arguments& a) {
  const Session session = ReadSession(a.config, a.model, a.seed);
  InterleavedEstimator recursions(session.settings);
  const Estimator& estimator = recursions.first();
  const auto source = OpenSource(RequestFor(a, session, estimator));
  std::optional<Verifier> verifier;
  if (a.verify) verifier.emplace(a.data, a.prefix, session.settings);

  std::ofstream out, predictions_file;
  std::optional<EstimateCsv> estimates;
  if (!a.out.empty()) {
    out = OpenOutput(a.out);
    estimates.emplace(estimator, &out);
  }
  std::optional<PredictionCsv> predictions;
  if (!a.predictions.empty()) {
    predictions_file = OpenOutput(a.predictions);
    predictions.emplace(&predictions_file, recursions.overlap());
  }
  StepCheck steps(session.settings.plant, recursions.overlap());
  ReplaySummary summary;
  {
    support::Progress progress(a.verify ? "verify" : "replay");
    summary = Replay(source.get(), &recursions, [&](const RecordedPack& recorded, const Estimate& estimate) {
      steps.Add(recorded.pack);
      if (estimates) estimates->Write(estimate);
      if (predictions) predictions->Write(recorded, estimate);
      if (verifier) verifier->Check(estimate);
      progress.Update(source->progress());
    });
  }
  if (estimates) Close(&out, a.out);
  if (predictions) Close(&predictions_file, a.predictions);
  std::optional<Verification> verification;
  if (verifier) verification = verifier->Finish();
  if (!a.report.empty()) WriteReport(a.report, estimator, *source, summary, verification);
  std::cout << SummaryText(estimator, *source, summary);
  if (const std::string warning = steps.Warning(estimator, summary.last); !warning.empty())
    std::cout << "WARNING: " << warning;
  if (estimates) std::cout << "estimates: " << a.out << '\n';
  if (summary.packs == 0) throw support::InputError(a.data + ": holds no usable pack");
  if (verification) std::cout << VerificationText(*verification, *source);
  return verification && !verification->equal() ? support::kExitFailure : support::kExitOk;
}

}  // namespace armcmc::replay
