#include <algorithm>
#include <cmath>
#include <functional>

#include "armcmc/gap_bench/score.hpp"
#include "armcmc/gap_bench/strata.hpp"
#include "armcmc/gap_bench/summary.hpp"

namespace armcmc::gap_bench {
namespace {

using Test = std::function<bool(const Outcome&)>;
constexpr double kTiny = 1e-12;

bool IsGrade(const Outcome& o, std::initializer_list<Grade> grades) {
  return std::find(grades.begin(), grades.end(), o.grade) != grades.end();
}
bool Covers(const Outcome& o) { return IsGrade(o, {Grade::kRight, Grade::kTie}); }
bool Right(const Outcome& o) { return o.grade == Grade::kRight; }
bool Wrong(const Outcome& o) { return IsGrade(o, {Grade::kWrong, Grade::kFailed}); }
bool FamilyHolds(const Outcome& o) { return IsGrade(o, {Grade::kRight, Grade::kTie, Grade::kFamily}); }
bool Flagged(const Outcome& o) { return o.grade == Grade::kUnnamed; }
bool HasName(const Outcome& o) { return !SetsOf(o.answer.result).empty(); }

Test In(std::initializer_list<const char*> strata) {
  const std::vector<std::string> names(strata.begin(), strata.end());
  return [names](const Outcome& o) { return std::find(names.begin(), names.end(), o.what.stratum) != names.end(); };
}
Test AtLeast(const Test& also, double strength) {
  return [=](const Outcome& o) { return also(o) && o.what.strength >= strength; };
}
Test Exactly(const Test& also, double strength) {
  return [=](const Outcome& o) { return also(o) && o.what.strength == strength; };
}

/// Gathers the gates of one run.
class Gatherer {
 public:
  explicit Gatherer(const std::vector<Outcome>& outcomes) : outcomes_(outcomes) {}

  /// Share of the cases of `which` for which `what` holds.
  void Share(const char* stratum, const std::string& metric, const Test& which, const Test& what, double limit,
             bool at_least) {
    int n = 0, count = 0;
    for (const Outcome& o : outcomes_) {
      if (!Counts(o) || !which(o)) continue;
      ++n;
      count += what(o) ? 1 : 0;
    }
    if (n > 0) Add(stratum, metric, static_cast<double>(count) / n, limit, at_least, n);
  }
  void Quantile(const char* stratum, const char* metric, double share, const Test& which,
                const std::function<double(const Outcome&)>& value, double limit, bool at_least) {
    std::vector<double> values;
    for (const Outcome& o : outcomes_)
      if (Counts(o) && which(o)) values.push_back(value(o));
    if (!values.empty())
      Add(stratum, metric, gap_bench::Quantile(values, share), limit, at_least, static_cast<int>(values.size()));
  }
  void Add(const char* stratum, const std::string& metric, double value, double limit, bool at_least, int n) {
    gates_.push_back({stratum, metric, value, limit, at_least, n});
  }
  [[nodiscard]] std::vector<Gate> Take() { return std::move(gates_); }

 private:
  const std::vector<Outcome>& outcomes_;
  std::vector<Gate> gates_;
};

void AddNames(Gatherer* g) {
  const Test null = In({"null"}), singles = In({"singles", "scale"}), pairs = In({"pairs"}), outside = In({"outside"});
  g->Share("null", "named", null, Wrong, 0.005, false);
  g->Share("null", "flagged", null, Flagged, 0.02, false);
  g->Share("singles", "truth in the set, R >= 0.3", AtLeast(singles, 0.3), Covers, 0.98, true);
  g->Share("singles", "right alone, R >= 1", AtLeast(singles, 1.0), Right, 0.92, true);
  g->Share("singles", "wrong, R >= 0.3", AtLeast(singles, 0.3), Wrong, 0.015, false);
  g->Share("singles", "wrong, R = 0.1", Exactly(singles, 0.1), Wrong, 0.01, false);
  g->Share("pairs", "truth in the set", pairs, Covers, 0.97, true);
  g->Share("pairs", "wrong", pairs, Wrong, 0.02, false);
  g->Share("outside", "false name", outside, Wrong, 0.03, false);
  g->Share("outside", "unnamed, or the name that it has for every plant", outside, Right, 0.93, true);
  g->Share("ablation", "false family", In({"ablation"}), Wrong, 0.05, false);
  g->Share("variants", "right family", In({"variants"}), FamilyHolds, 0.88, true);
  g->Share("variants", "wrong", In({"variants"}), Wrong, 0.02, false);
}

/// The second plant, by what is hidden: nothing, an effect of its catalogue, or another one.
void AddActuator(Gatherer* g) {
  const Test all = In({"actuator"});
  const auto kind = [](const Outcome& o) { return o.truth.effects.empty() ? "" : o.truth.effects.front().kind; };
  const Test null = [=](const Outcome& o) { return all(o) && o.what.effect == "none"; };
  const Test outside = [=](const Outcome& o) { return all(o) && kind(o) == "outside"; };
  const Test hidden = [=](const Outcome& o) { return all(o) && !null(o) && !outside(o); };
  g->Share("actuator", "nothing hidden: named", null, Wrong, 0.005, false);
  g->Share("actuator", "nothing hidden: flagged", null, Flagged, 0.02, false);
  g->Share("actuator", "truth in the set", hidden, Covers, 0.95, true);
  g->Share("actuator", "wrong", hidden, Wrong, 0.02, false);
  g->Share(
      "actuator", "right equation", [=](const Outcome& o) { return hidden(o) && o.equation_right.has_value(); },
      [](const Outcome& o) { return o.equation_right.value_or(false); }, 0.98, true);
  g->Share("actuator", "outside the catalogue: false name", outside, Wrong, 0.03, false);
}

/// Where the plant is not the catalogue: a name says which family of physics is there, not that its formula holds.
void AddImperfect(Gatherer* g) {
  for (const char* stratum : {"law_error", "actuator_law_error", "unlisted", "formulas", "strokes", "strong_pairs"}) {
    const Test all = In({stratum});
    g->Share(stratum, "right family", all, FamilyHolds, 0.95, true);
    g->Share(stratum, "false family", all, Wrong, 0.01, false);
    g->Quantile(
        stratum, "closed of what the truth closes, 10 % quantile", 0.1,
        [=](const Outcome& o) { return all(o) && FamilyHolds(o) && o.first_rung.has_value(); },
        [](const Outcome& o) { return o.first_rung.value_or(0.0); }, 0.8, true);
  }
  g->Share("near_null", "named", In({"near_null"}), Wrong, 0.01, false);
}

void AddMotions(Gatherer* g) {
  const Test onset = In({"onset"}), poor = In({"poor"}), modes = In({"modes"}), paper = In({"paper"});
  g->Share("onset", "truth in the set", onset, Covers, 0.97, true);
  g->Share("modes", "truth in the set", modes, Covers, 0.97, true);
  g->Share(
      "modes", "mode right, of those found", [&](const Outcome& o) { return modes(o) && Covers(o); },
      [](const Outcome& o) { return o.when_right.value_or(false); }, 0.85, true);
  g->Share("poor", "wrong", poor, Wrong, 0.01, false);
  g->Share(
      "poor", "truth in the set, where there is one", [&](const Outcome& o) { return poor(o) && HasName(o); }, Covers,
      0.99, true);
  g->Share("ties", "right alone after the experiment", In({"ties"}), Right, 0.90, true);
  g->Share("ties", "wrong", In({"ties"}), Wrong, 0.02, false);
  g->Share("paper", "truth in the set", paper, Covers, 1.0, true);
  g->Share("paper", "wrong", paper, Wrong, 0.0, false);
}

/// Whether the halves of a recording are given names that cannot both be right.
bool Contradict(const Outcome& first, const Outcome& second) {
  const auto sets = [](const Outcome& o) { return ScoredSets(o.what, o.truth, o.answer.result); };
  const auto a = sets(first), b = sets(second);
  return !a.empty() && !b.empty() && std::none_of(a.begin(), a.end(), [&](const auto& set) {
    return std::find(b.begin(), b.end(), set) != b.end();
  });
}

/// Real motion and real noise.
void AddRecordings(const std::vector<Outcome>& outcomes, Gatherer* g) {
  const Test all = In({kRecorded});
  for (const bool real_noise : {false, true}) {
    const Test some = [=](const Outcome& o) { return all(o) && (o.what.group == kRealNoise) == real_noise; };
    const Test null = [=](const Outcome& o) { return some(o) && o.what.effect == "none"; };
    const Test hidden = [=](const Outcome& o) { return some(o) && !null(o); };
    const std::string kind = real_noise ? std::string(kRealNoise) + ": " : "real motion: ";
    g->Share(kRecorded, kind + "named, where nothing is hidden", null, Wrong, 0.03, false);
    g->Share(kRecorded, kind + "truth in the set", hidden, Covers, 0.95, true);
    g->Share(kRecorded, kind + "wrong", hidden, Wrong, 0.03, false);
  }
  int halved = 0, contradicted = 0;
  for (const Outcome& first : outcomes) {
    if (!all(first) || first.what.part != Part::kFirstHalf) continue;
    const auto second = std::find_if(outcomes.begin(), outcomes.end(), [&](const Outcome& o) {
      return o.what.part == Part::kSecondHalf && o.what.scenario == first.what.scenario &&
             o.what.effect == first.what.effect;
    });
    if (second == outcomes.end() || !Counts(first) || !Counts(*second)) continue;
    ++halved;
    contradicted += Contradict(first, *second) ? 1 : 0;
  }
  if (halved > 0)
    g->Add("recorded", "halves contradict each other", static_cast<double>(contradicted) / halved, 0.03, false, halved);
}

void AddProof(Gatherer* g) {
  const auto gap = [](double (*value)(const gap::GapSummary&)) {
    return [value](const Outcome& o) { return value(o.answer.result.gap); };
  };
  const auto closed = gap([](const gap::GapSummary& s) { return s.closed_fraction; });
  const auto over_floor = gap([](const gap::GapSummary& s) { return s.after.rmse / std::max(s.noise_floor, kTiny); });
  const auto whiteness = gap([](const gap::GapSummary& s) { return s.after.whiteness; });
  const auto covered = gap([](const gap::GapSummary& s) { return s.after.coverage95; });
  g->Quantile("gap", "closed, median", 0.5, ShownClosed, closed, 0.98, true);
  g->Quantile("gap", "closed, 10 % quantile", 0.1, ShownClosed, closed, 0.93, true);
  g->Quantile("gap", "rms error over noise, median", 0.5, ShownClosed, over_floor, 1.03, false);
  g->Quantile("gap", "whiteness, median", 0.5, ShownClosed, whiteness, 2.0, false);
  g->Quantile("gap", "coverage of 95 % bands, median", 0.5, ShownClosed, covered, 0.93, true);
  g->Quantile("gap", "coverage of 95 % bands, median", 0.5, ShownClosed, covered, 0.97, false);
  g->Share(
      "gap", "runner-up closes less",
      [](const Outcome& o) { return ShownClosed(o) && !o.answer.result.gap.control_effects.empty(); },
      [](const Outcome& o) {
        return o.answer.result.gap.control_closed_fraction < o.answer.result.gap.closed_fraction;
      },
      0.95, true);
}

void AddOnsets(const Onsets& onsets, Gatherer* g) {
  if (onsets.n == 0) return;
  g->Add("onset", "onset within 20 ms, of those found", onsets.within_20_ms, 0.85, true, onsets.n);
  g->Add("onset", "onset within 0.2 s, of those found", onsets.within_200_ms, 0.85, true, onsets.n);
}

/// Relative errors of the base parameters, before and after the effect was added.
void AddBias(const std::vector<Outcome>& outcomes, Gatherer* g) {
  std::vector<double> before, after;
  for (const Outcome& o : outcomes) {
    if (o.what.stratum != "singles" || o.what.strength < 3.0 || !Right(o)) continue;
    for (const gap::ParameterChange& change : o.answer.result.parameters)
      for (const auto& [name, truth] : o.truth.base_parameters) {
        if (name != change.before.name || truth == 0.0) continue;
        before.push_back(std::abs(change.before.mean / truth - 1.0));
        after.push_back(std::abs(change.after.mean / truth - 1.0));
      }
  }
  if (after.empty()) return;
  const auto n = static_cast<int>(after.size());
  g->Add("bias", "K, B, p: median error before over after, R = 3",
         Quantile(before, 0.5) / std::max(Quantile(after, 0.5), kTiny), 10.0, true, n);
  g->Add("bias", "K, B, p: 90 % quantile of the error after, R = 3", Quantile(after, 0.9), 0.01, false, n);
}

}  // namespace

std::vector<Gate> Gates(const std::vector<Outcome>& outcomes) {
  Gatherer g(outcomes);
  AddNames(&g);
  AddImperfect(&g);
  AddMotions(&g);
  AddActuator(&g);
  AddRecordings(outcomes, &g);
  AddOnsets(LocateOnsets(outcomes), &g);
  AddProof(&g);
  AddBias(outcomes, &g);
  for (const bool imperfect : {false, true}) {
    std::vector<Outcome> some = outcomes;
    std::erase_if(some, [=](const Outcome& o) { return Imperfect(o.what.stratum) != imperfect; });
    const char* name = imperfect ? "calibration, plant not the catalogue" : "calibration";
    const Calibration calibration = Calibrate(some);
    if (calibration.n > 0) g.Add(name, "expected error", calibration.error, 0.05, false, calibration.n);
    const ConfidentLabels sure = CountConfident(some);
    if (sure.n > 0) g.Add(name, "right when P >= 0.9", static_cast<double>(sure.right) / sure.n, 0.93, true, sure.n);
  }
  g.Quantile(
      "time", "processor seconds a log, median", 0.5, In({"singles", "scale", "pairs"}),
      [](const Outcome& o) { return o.answer.cpu_s; }, 1.0, false);
  return g.Take();
}

}  // namespace armcmc::gap_bench
