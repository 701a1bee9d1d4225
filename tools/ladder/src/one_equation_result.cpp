#include "one_equation.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "armcmc/gap/effect_words.hpp"
#include "armcmc/gap/result.hpp"
#include "armcmc/ladder/evidence.hpp"
#include "armcmc/ladder/experiment.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/sha256.hpp"
#include "estimates.hpp"
#include "held_out.hpp"
#include "repeated.hpp"
#include "shares.hpp"

namespace armcmc::ladder {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using gap::ParameterEstimate;
using gap::Verdict;

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

std::string WithSd(double value, double sd, const std::string& unit) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.4g ± %.2g %s", value, sd, unit.c_str());
  return text;
}

std::string NameOf(const Contender& c) { return c.candidate.entry->name; }

/// Names added before a rung.
std::vector<std::string> NamesBefore(const Ladder& ladder, std::size_t rung) {
  std::vector<std::string> names;
  for (std::size_t r = 0; r < rung; ++r) names.push_back(NameOf(ladder.rungs[r].leader()));
  return names;
}

/// Writes the result from the ladder.
class ResultWriter {
 public:
  ResultWriter(const DiagnosisRequest& request, const Dataset& data, const Ladder& ladder, gap::Result* result)
      : request_(request), data_(data), ladder_(ladder), result_(*result), training_(ladder.view.data.training) {}

  void WriteAll() {
    WriteOrigin();
    WriteGap();
    WriteLadder();
    WriteCandidates();
    WriteParameters();
    WriteRemainder();
    WriteVerdict();
  }

 private:
  void WriteOrigin() {
    const support::Recording& recording = request_.recording;
    result_.version = support::Version();
    result_.model = recording.plant;
    result_.equation = request_.equation;
    result_.data_file = recording.title;
    std::vector<std::string> sums;
    for (const std::filesystem::path& file : recording.files) sums.push_back(support::Sha256OfFile(file));
    result_.data_sha256 = JoinedWords(sums, ", ");
    result_.rows = static_cast<long long>(recording.num_rows());
    result_.dt = recording.dt;
    result_.notes = recording.notes;
    result_.notes.insert(result_.notes.end(), ladder_.notes.begin(), ladder_.notes.end());
    for (const support::PublishedFigure& p : recording.published)
      result_.published.push_back({p.what, p.value, p.source});
  }

  void WriteGap() {
    before_ = RunWhole(data_, ladder_.base);
    after_ = RunWhole(data_, ladder_.final_trial);
    rows_ = HeldOutRows(data_, before_);
    if (rows_.empty()) result_.notes.push_back("no data were held out: errors are those of the fit itself");
    if (rows_.empty())
      for (std::size_t n = 0; n < data_.training.size(); ++n)
        if (data_.training[n] != 0 && before_.model->active()[n] != 0) rows_.push_back(static_cast<Index>(n));
    gap::GapSummary& gap = result_.gap;
    gap.unit = OutputUnit();
    gap.before = FitOn(before_, rows_, ladder_.base.fit.error_sd);
    gap.after = FitOn(after_, rows_, ladder_.final_trial.fit.error_sd);
    WriteNoiseFloor();
    complete_ = ladder_.complete && !HeldOutContradicts();
    gap.closed_fraction = Closed(gap.after.rmse);
    CloseInterval(rows_, before_, after_, request_.seed, &gap);
    gap.stretches = StretchesOf(data_, rows_, before_, after_);
    gap.gap_ratio = ladder_.base.fit.error_sd / std::max(gap.noise_floor, 1e-300);
    const VectorXd target = before_.model->target()(rows_);
    const double size = std::sqrt(target.squaredNorm() / static_cast<double>(target.size()));
    result_.relative_before = gap.before.rmse / size;
    result_.relative_after = gap.after.rmse / size;
  }

  void WriteNoiseFloor() {
    const double left = ladder_.final_trial.fit.error_sd * std::sqrt(std::max(0.0, 1.0 - ladder_.flexible_gain));
    const double differences = ladder_.noise_floor;
    std::string from;
    if (differences > left) {
      result_.gap.noise_floor = left;
      from = "neighbouring samples differ by more (" + Number(differences) +
             ") than models leave, since the signal moves between them; taken from what a flexible model leaves";
    } else if (ladder_.complete && left > kShared * differences) {
      result_.gap.noise_floor = left;
      from = "neighbouring samples share noise and differ by less (" + Number(differences) +
             "); taken from what the model leaves, which is forgotten within a tenth of the period";
    } else {
      result_.gap.noise_floor = differences;
      from = std::string("from differences of neighbouring samples") +
             (request_.recording.smoothed_noise > 0.0         ? " before the filter, "
              : request_.recording.noise_in_differences < 1.0 ? ", which share noise where they are interpolated, "
                                                              : ", ") +
             Number(differences);
    }
    result_.notes.push_back("noise floor: " + from);
  }

  /// Whether the errors on the held-out rows are far above the noise, although the model explains the training rows.
  bool HeldOutContradicts() {
    const gap::GapSummary& gap = result_.gap;
    if (!ladder_.complete || HeldOutRows(data_, before_).empty()) return false;
    if (!(gap.after.rmse > kContradicted * gap.noise_floor)) return false;
    result_.notes.push_back("the error on the held-out rows is " + Number(gap.after.rmse / gap.noise_floor) +
                            " times the noise, under a model that explains all other rows: they show something that "
                            "the others do not. Hold out other rows, so that it can be named");
    return true;
  }

  /// Says which errors other constants alone would leave, if effects were named as well.
  void WriteConstants() {
    if (!ladder_.free_constants) return;
    const double alone = FitOn(RunWhole(data_, ladder_.rungs.front().base), rows_, 0.0).rmse;
    result_.notes.push_back(
        "the constants of the plant were fitted as well, each up to 5 % from the value in the file: alone they change "
        "the error from " +
        Number(result_.gap.before.rmse) + " to " + Number(alone));
  }

  void WriteLadder() {
    WriteConstants();
    for (std::size_t r = 0; r < ladder_.rungs.size(); ++r) {
      const Rung& rung = ladder_.rungs[r];
      if (rung.named.empty()) continue;
      const Contender& leader = rung.leader();
      gap::LadderRung entry;
      for (const std::size_t i : rung.named) entry.effects.push_back(NameOf(rung.contenders[i]));
      const WholeRun run = RunWhole(data_, leader.trial);
      entry.heldout_error = FitOn(run, rows_, leader.trial.fit.error_sd).rmse;
      if (!std::isfinite(entry.heldout_error)) {  // that of the last model that does not diverge
        entry.heldout_error = result_.ladder.empty() ? result_.gap.before.rmse : result_.ladder.back().heldout_error;
        result_.notes.push_back(leader.candidate.entry->name +
                                " alone diverges on held-out data: named because of what follows");
      }
      entry.closed_fraction = Closed(entry.heldout_error);
      entry.probability = rung.probability;
      entry.provisional = rung.provisional;
      entry.remainder_ratio = leader.trial.fit.error_sd / std::max(result_.gap.noise_floor, 1e-300);
      const Estimated all = Estimates(leader.trial, training_);
      for (std::size_t d = leader.candidate.first_fitted(); d < all.parameters.size(); ++d)
        if (const ParameterEstimate& p = all.parameters[d]; p.confounded_with.empty())
          entry.parameters.push_back(p.name + " = " + WithSd(p.mean, p.sd, p.unit));
      for (const gap::Combination& c : all.determined)
        entry.parameters.push_back(c.text + " = " + WithSd(c.value, c.sd, c.unit));
      result_.ladder.push_back(entry);
      AddFinding(leader, rung);
    }
  }

  void AddFinding(const Contender& leader, const Rung& rung) {
    gap::EffectFinding finding;
    finding.name = NameOf(leader);
    finding.family = leader.candidate.entry->family;
    finding.probability = rung.probability;
    finding.provisional = rung.provisional;
    finding.approximate = leader.candidate.form().variant || !complete_;
    finding.formula_text = leader.candidate.form().terms.front().formula;
    const std::vector<ParameterEstimate> all = Estimates(ladder_.final_trial, training_).parameters;
    const std::vector<EffectParameter>& own = leader.candidate.form().parameters;
    for (std::size_t k = 0; k < own.size(); ++k) {
      const ParameterEstimate& fitted = all.at(leader.candidate.first_fitted() + k);
      finding.parameters.push_back({own[k].name, fitted.unit, fitted.mean, fitted.sd, fitted.confounded_with});
    }
    result_.effects.push_back(std::move(finding));
  }

  void WriteCandidates() {
    for (std::size_t r = 0; r < ladder_.rungs.size(); ++r) {
      const Rung& rung = ladder_.rungs[r];
      const std::map<std::string, double> shares = SharesOf(rung);
      const auto active_rows = static_cast<double>(ladder_.view.active_rows.size());
      std::set<std::string> written;
      for (const Contender& c : rung.contenders) {
        if (!c.trial.judged || !written.insert(NameOf(c)).second) continue;
        gap::CandidateScore score;
        score.effects = NamesBefore(ladder_, r);
        score.effects.push_back(NameOf(c));
        score.log_evidence = -c.trial.fit.cost;
        score.heldout_score = -0.5 * active_rows * std::log(c.alone.folds + 1e-300);
        score.probability = r == 0 ? shares.at(NameOf(c)) : 0.0;
        score.closed_fraction = std::clamp(1.0 - c.alone.folds, 0.0, 1.0);
        result_.candidates.push_back(std::move(score));
      }
    }
  }

  void WriteParameters() {
    const Estimated before = Estimates(ladder_.base, training_);
    const Estimated after = Estimates(ladder_.final_trial, training_);
    for (std::size_t d = 0; d < before.parameters.size(); ++d)
      result_.parameters.push_back({before.parameters[d], after.parameters[d]});
    result_.determined = after.determined;
  }

  void WriteRemainder() {
    const std::vector<Feature> features = FeaturesOf(*before_.model, ladder_.base.fit.theta);
    std::vector<Index> rows;
    const std::size_t every = std::max<std::size_t>(1, data_.training.size() / 4000);
    for (std::size_t n = 0; n < data_.training.size(); n += every)
      if (data_.training[n] != 0 && before_.model->active()[n] != 0) rows.push_back(static_cast<Index>(n));
    if (before_.error.size() > 0)
      result_.where = WhereErrorsAre(before_.error, features, rows, result_.gap.noise_floor);
    for (gap::Where& where : result_.where)
      if (!request_.equation.empty()) where.feature = request_.equation + ": " + where.feature;
    if (after_.error.size() > 0) {
      const double noise = result_.gap.noise_floor * result_.gap.noise_floor;
      const double base = ladder_.base.fit.error_sd * ladder_.base.fit.error_sd - noise;
      const double left = ladder_.final_trial.fit.error_sd * ladder_.final_trial.fit.error_sd - noise;
      result_.complete = complete_;
      result_.remainder.share = base > 0.0 ? std::clamp(left / base, 0.0, 1.0) : 0.0;
      if (!complete_) {
        result_.remainder.where = WhereErrorsAre(after_.error, features, rows, result_.gap.noise_floor);
        result_.remainder.sparse = SparseSum(after_.error, features, rows);
      }
      if (NumNamed(ladder_) == 0) result_.sparse = result_.remainder.sparse;
    }
    const PlantDescription& plant = request_.plant->plant.description();
    const bool named = NumNamed(ladder_) > 0;
    if (before_.error.size() > 0 && after_.error.size() > 0)
      result_.figures = FiguresOf(data_, before_, named ? &after_ : nullptr, features,
                                  plant.signals[static_cast<std::size_t>(request_.plant->plant.output())]);
  }

  void WriteVerdict() {
    const std::size_t named = NumNamed(ladder_);
    const Rung* first = named > 0 ? &ladder_.rungs.front() : nullptr;
    if (first != nullptr) {
      result_.verdict = first->named.size() > 1 ? Verdict::kAmbiguous : Verdict::kNamed;
      double won = 0.0;
      for (const auto& [name, share] : SharesOf(*first)) won += share;
      result_.probability_none = std::max(1.0 - won, 0.0);
      result_.probability_unnamed = 0.0;
    } else {
      result_.verdict = complete_ ? Verdict::kNone : Verdict::kUnnamed;
      result_.probability_none = complete_ ? 1.0 : 0.0;
      result_.probability_unnamed = complete_ ? 0.0 : 1.0;
    }
    std::vector<std::string> shows;
    const Rung* tie = nullptr;
    for (std::size_t r = 0; r < ladder_.rungs.size(); ++r) {
      const Rung& rung = ladder_.rungs[r];
      if (rung.named.size() < 2) continue;
      tie = &rung;
      for (const std::size_t i : rung.named) {
        if (r == 0) result_.ambiguous_set.push_back({NameOf(rung.contenders[i])});
        shows.push_back(NameOf(rung.contenders[i]) + ": " + rung.contenders[i].candidate.entry->experiment);
      }
    }
    if (tie != nullptr) {
      const auto begin = std::chrono::steady_clock::now();
      // With two equations, a signal that one reads may result from the other, so it cannot be prescribed.
      if (request_.equation.empty())
        result_.separate_by = SeparatingMotion(data_, *tie, request_.plant->plant.description());
      result_.seconds.emplace_back("experiment",
                                   std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      if (!result_.separate_by.words.empty()) result_.separate_by.words += ' ';
      result_.separate_by.words += "What shows each of them: " + JoinedWords(shows, " ");
    }
    result_.sentence = Sentence();
  }

  std::string Sentence() const {
    const std::string percent = Number(std::round(1000.0 * result_.gap.closed_fraction) / 10.0);
    const std::string in = request_.equation.empty() ? "" : " in the " + request_.equation;
    if (result_.ladder.empty())
      return complete_ ? "Nothing is missing as far as these data show: the model explains them down to the noise."
                       : "Something is missing" + in +
                             ", and no effect of the catalogue that this plant can have explains it well enough to be "
                             "named." +
                             ActsAsIf();
    std::vector<std::string> rungs;
    for (const Rung& rung : ladder_.rungs) {
      if (rung.named.empty()) continue;
      std::vector<std::string> titles;
      for (const std::size_t i : rung.named) titles.push_back(gap::EffectInSentence(NameOf(rung.contenders[i])));
      rungs.push_back(JoinedWords(titles, " or "));
    }
    return "Missing" + in + ": " + JoinedWords(rungs, ", then ") + ". With that, " + percent +
           " % of the gap on held-out data is closed" +
           (complete_ ? ", and nothing is left to explain." : "; something is still unexplained." + ActsAsIf()) +
           WithConstants() + WhyRepeated(ladder_);
  }

  /// The rival of the last rung, which describes the remaining misfit.
  [[nodiscard]] std::string ActsAsIf() const {
    const bool known =
        !ladder_.rungs.empty() && ladder_.rungs.back().named.empty() && !ladder_.rungs.back().as_if.empty();
    return known ? " It acts as if " + ladder_.rungs.back().as_if + "." : "";
  }

  /// The constants that were fitted together with the effects.
  [[nodiscard]] std::string WithConstants() const {
    if (!ladder_.free_constants) return "";
    return " Besides, the plant acts as if " + AsIf(*ladder_.free_constants, ladder_.final_trial, training_) + ".";
  }

  [[nodiscard]] double Closed(double rmse) const {
    const double noise = result_.gap.noise_floor * result_.gap.noise_floor;
    const double base = result_.gap.before.rmse * result_.gap.before.rmse - noise;
    return base > 0.0 ? (result_.gap.before.rmse * result_.gap.before.rmse - rmse * rmse) / base : 0.0;
  }

  /// Unit of the quantity that the laws explain.
  [[nodiscard]] std::string OutputUnit() const {
    const Plant& plant = request_.plant->plant;
    const PlantDescription& description = plant.description();
    for (std::size_t m = 0; m < description.modes.size(); ++m)
      if (!plant.modes()[m].passive && !description.modes[m].target.empty())
        return plant.modes()[m].target_unit ? plant.modes()[m].target_unit->Text() : "";
    return description.signals[static_cast<std::size_t>(plant.output())].unit;
  }

  static constexpr double kShared = 1.2;        ///< Times the noise floor from differences.
  static constexpr double kContradicted = 1.5;  ///< Times the noise (rms), on held-out rows.

  const DiagnosisRequest& request_;
  const Dataset& data_;
  const Ladder& ladder_;
  gap::Result& result_;
  std::vector<std::uint8_t> training_;
  bool complete_ = false;  ///< Nothing is left to explain, on the held-out rows as well.
  WholeRun before_, after_;
  std::vector<Index> rows_;  ///< Rows of the reported errors.
};

}  // namespace

std::string JoinedWords(const std::vector<std::string>& words, const char* between) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + word;
  return out;
}

std::size_t NumNamed(const Ladder& ladder) {
  return static_cast<std::size_t>(
      std::count_if(ladder.rungs.begin(), ladder.rungs.end(), [](const Rung& r) { return !r.named.empty(); }));
}

void Tell(const DiagnosisRequest& request, const Dataset& data, Diagnosis* diagnosis) {
  diagnosis->result = {};
  ResultWriter(request, data, diagnosis->ladder, &diagnosis->result).WriteAll();
}

}  // namespace armcmc::ladder
