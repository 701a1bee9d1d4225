#include "armcmc/gap/report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tools/file_text.hpp"
#include "tools/gap/report_fixture.hpp"

namespace armcmc::gap::report_test {
namespace {

using armcmc::test::Holds;

TEST(Report, NamedTellsEffectGapAndParameter) {
  const std::string html = ReportHtml(test::ExampleResult(Verdict::kNamed));
  for (const char* words : {"The model lacks dry friction", "Probability: 99.1 %", "0.0801 <small>N", "0.0203 <small>N",
                            "0.0200 <small>N", "<b>99.5 %</b> of the explainable", "0.07873 to 0.08147"})
    EXPECT_TRUE(Holds(html, words)) << words;
  EXPECT_FALSE(Holds(html, "Several explanations fit"));
  EXPECT_FALSE(Holds(html, "not in the catalogue. Nothing"));
}

TEST(Report, ConfoundedParametersHaveNoIntervalButTheirSumHas) {
  Result result = test::ExampleResult(Verdict::kNamed);
  EXPECT_FALSE(Holds(ReportHtml(result), "Parameters that these data do not separate"));
  result.effects[0].parameters = {{"force", "N", 13.319, 16.4, {"pull & push"}}};
  result.determined = {{"force + pull", {"force", "pull"}, 20.0251, 0.049, "N"}};
  const std::string html = ReportHtml(result);
  for (const char* words : {"<b>13.3&nbsp;N</b> <span class=\"soft\">(confounded with pull &amp; push)",
                            "Parameters that these data do not separate", "force + pull</span> = <b>20.025&nbsp;N</b>",
                            "(95 %: 19.929 to 20.121)"})
    EXPECT_TRUE(Holds(html, words)) << words;
  EXPECT_FALSE(Holds(html, "-18.8"));
}

TEST(Report, AmbiguousListsTheExplanationsAndTheExperimentThatWouldDecide) {
  const std::string html = ReportHtml(test::ExampleResult(Verdict::kAmbiguous));
  EXPECT_TRUE(Holds(html, "Probability that it is one of these: 97.9 %"));
  EXPECT_TRUE(Holds(html, "Several explanations fit these data equally well."));
  EXPECT_TRUE(Holds(html, "<li>Sensor delay</li>"));
  EXPECT_TRUE(Holds(html, "Tap the surface five times"));
  EXPECT_TRUE(Holds(html, "separate.toml"));
}

TEST(Report, ShowsTheProposedMotionAlsoOfATieBehindAName) {
  Result result = test::ExampleResult(Verdict::kAmbiguous);
  EXPECT_FALSE(Holds(ReportHtml(result), "The proposed motion."));
  result.separate_by.course.x = {0.0, 1.0};
  result.separate_by.course.y = {0.0, 0.1};
  result.separate_by.course_title = "q, m";
  EXPECT_TRUE(Holds(ReportHtml(result), "The proposed motion."));
  result.verdict = Verdict::kNamed;
  result.ambiguous_set.clear();
  EXPECT_FALSE(Holds(ReportHtml(result), "Effects that these data cannot distinguish"));
  result.ladder.resize(2);
  result.ladder[0].effects = {"coulomb_friction"};
  result.ladder[1].effects = {"sensor_lag", "sensor_delay"};
  const std::string html = ReportHtml(result);
  EXPECT_TRUE(Holds(html, "Effects that these data cannot distinguish"));
  EXPECT_TRUE(Holds(html, "<li>Sensor delay</li>"));
  EXPECT_TRUE(Holds(html, "The proposed motion."));
}

TEST(Report, UnnamedSaysThatTheCauseIsUnknownAndAddsNothing) {
  const std::string html = ReportHtml(test::ExampleResult(Verdict::kUnnamed));
  EXPECT_TRUE(Holds(html, "The model is missing an effect that is not in the catalogue. Nothing was added"));
  EXPECT_TRUE(Holds(html, "Nothing; the model is unchanged."));
  EXPECT_TRUE(Holds(html, "sin(9 x^2)"));
  EXPECT_FALSE(Holds(html, "\"role\":\"after\""));
}

TEST(Report, NoneSaysThatNothingIsMissing) {
  const std::string html = ReportHtml(test::ExampleResult(Verdict::kNone));
  EXPECT_TRUE(Holds(html, "Probability that nothing is missing: 98.7 %"));
  EXPECT_FALSE(Holds(html, "tile after"));
}

TEST(Report, ListsNothingAndNotInTheCatalogueAmongTheExplanations) {
  for (const Verdict verdict : {Verdict::kNone, Verdict::kNamed, Verdict::kAmbiguous, Verdict::kUnnamed}) {
    const std::string html = ReportHtml(test::ExampleResult(verdict));
    EXPECT_TRUE(Holds(html, "<i>Nothing is missing</i>"));
    EXPECT_TRUE(Holds(html, "<i>Something that is not in the catalogue</i>"));
  }
}

TEST(Report, KeepsTheListOfExplanationsShort) {
  Result result = test::ExampleResult(Verdict::kNamed);
  for (int i = 0; i < 200; ++i) result.candidates.push_back({{"effect_" + std::to_string(i)}, 0.0, 0.0, 1e-6, 0.0});
  const std::string html = ReportHtml(result);
  EXPECT_TRUE(Holds(html, "further candidates were tested; their total probability is < 0.1 %"));
  EXPECT_FALSE(Holds(html, "Effect 199"));
  EXPECT_TRUE(Holds(html, "<i>Nothing is missing</i>"));
}

TEST(Report, ParametersOfAnEffectKeepTheirNames) {
  Result result = test::ExampleResult(Verdict::kNamed);
  result.effects.front().parameters = {{"cm", "N s/m", 1.0, 0.1}, {"Fm", "N", 1.0, 0.1}};
  const std::string html = ReportHtml(result);
  EXPECT_TRUE(Holds(html, "<dt>cm</dt>"));
  EXPECT_TRUE(Holds(html, "<dt>Fm</dt>"));
}

TEST(Report, ComposesASentenceWhereThereIsNone) {
  Result result = test::ExampleResult(Verdict::kNamed);
  result.sentence.clear();
  EXPECT_TRUE(Holds(ReportHtml(result), "<h1>The model is missing Coulomb friction.</h1>"));
}

/// Puts the same text wherever the result has text.
void FillText(Result* r, const std::string& text) {
  for (std::string* s : {&r->version, &r->model, &r->data_file, &r->data_sha256, &r->sentence, &r->model_file,
                         &r->gap.unit, &r->gap.control_effects, &r->separate_by.words, &r->separate_by.scenario_file,
                         &r->figures.output_title, &r->figures.where.x_title, &r->figures.where.y_title,
                         &r->figures.where.value_title, &r->figures.residual_before.label})
    *s = text;
  r->notes = r->aliases = {text};
  r->ambiguous_set = {{text, text}};
  r->candidates = {{{text}, 1.0, 1.0, 0.5, 0.5}};
  r->where = {{text, text, 0.5, 1.0, 0.1}};
  r->sparse = {{text, 1.0, 0.5}};
  r->gap.modes = {{text, 1, 1.0, 1.0}};
  r->parameters = {{{text, text, 1.0, 0.1}, {text, text, 1.0, 0.1}}};
  r->effects = {{text, text, 0.5, {{text, text, 1.0, 0.1}}, {}, true, true}};
  r->seconds = {{text, 1.0}};
  for (FeatureFigure& figure : r->figures.features) figure.feature = figure.effect.label = text;
}

TEST(Report, EscapesEveryTextOfTheResult) {
  for (const Verdict verdict : {Verdict::kNone, Verdict::kNamed, Verdict::kAmbiguous, Verdict::kUnnamed}) {
    Result result = test::ExampleResult(verdict);
    FillText(&result, "</script><img src=x onerror=\"alert('x')\">");
    const std::string html = ReportHtml(result);
    EXPECT_FALSE(Holds(html, "<img"));
    EXPECT_FALSE(Holds(html, "</script><"));
    result.effects.clear();
    EXPECT_FALSE(Holds(ReportHtml(result), "<img"));
  }
}

TEST(Report, ShowsTheEstimatorOnTheRecording) {
  Result result = test::ExampleResult(Verdict::kNamed);
  EXPECT_FALSE(Holds(ReportHtml(result), "The estimator on this recording"));
  ParameterDrift& drift = result.drift.emplace_back();
  drift.name = "M<b>";
  drift.unit = "kg";
  drift.before = {true, {"", {1.0, 3.0}, {90.0, 99.0}, {89.0, 98.0}, {91.0, 100.0}}, 94.0, 4.7, 1e-9, false};
  drift.after = {true, {"", {1.0, 3.0}, {95.0, 95.2}, {94.0, 94.0}, {96.0, 96.0}}, 95.1, 0.0, 0.6, true};
  result.run.why_not = "no run has the 100 samples of a pack";
  std::string page = ReportHtml(result);
  for (const char* words :
       {"M&lt;b&gt;", "varies by ± 4.7&nbsp;kg", ">constant<", "Not available: no run has the 100 samples"})
    EXPECT_TRUE(Holds(page, words)) << words;
  result.run = {};
  result.run.done = result.run.has_after = true;
  result.run.pack_s = 0.1;
  result.run.before = {1000, 6.98, 0.774, 4.58};
  result.run.after = {1000, 2.27, 0.947, 2.54};
  page = ReportHtml(result);
  for (const char* words : {"77.4 %", "94.7 %", "contain about 95 %"}) EXPECT_TRUE(Holds(page, words)) << words;
}

TEST(Report, ReadsTheIntervalsOfThePredictionsAndSaysWhatIsNotDetermined) {
  Result result = test::ExampleResult(Verdict::kNamed);
  ParameterDrift& drift = result.drift.emplace_back();
  drift.name = "M";
  drift.before.fitted = true;  // in no segment
  result.run.done = true;
  result.run.pack_s = 0.1;
  result.run.before = {1000, 6.98, 0.774, 4.58};
  std::string page = ReportHtml(result);
  for (const char* words : {"contain fewer than 95 % of the samples",
                            "<td class=\"soft\">not determined</td><td class=\"soft num\">–</td>"})
    EXPECT_TRUE(Holds(page, words)) << words;
  EXPECT_FALSE(Holds(page, "held-out rows</td>"));
  // With the named effects it is their coverage that is read.
  result.run.has_after = true;
  result.run.after = {1000, 2.27, 0.999, 9.0};
  result.run.before_apart = {300, 7.51, 0.75, 4.6};
  result.run.after_apart = {300, 2.53, 0.94, 2.6};
  page = ReportHtml(result);
  for (const char* words : {"contain more than 95 % of the samples",
                            "base model, held-out rows</td><td class=\"num\">300</td><td class=\"num\">7.51",
                            "</b>, held-out rows</td><td class=\"num\">300</td><td class=\"num\">2.53"})
    EXPECT_TRUE(Holds(page, words)) << words;
  EXPECT_FALSE(Holds(page, "contain fewer than"));
}

TEST(Report, TellsWhatTheLadderLeavesUnexplained) {
  Result result = test::ExampleResult(Verdict::kNamed);
  LadderRung& rung = result.ladder.emplace_back();
  rung.effects = {"coulomb_friction"};
  rung.parameters = {"Fc = 20.4 < 21 N"};
  result.complete = true;
  std::string page = ReportHtml(result);
  EXPECT_TRUE(Holds(page, "Fc = 20.4 &lt; 21 N"));
  EXPECT_TRUE(Holds(page, "No misfit remains"));
  EXPECT_FALSE(Holds(page, "remains unexplained"));

  result.complete = false;
  result.remainder.share = 0.42;
  result.remainder.where = {{"v", "in contact, v < 0", 0.61, 0.0, 0.0}, {"x", "x > 1", 0.13, 0.0, 0.0}};
  result.remainder.sparse = {{"v |v|", -1.25, 0.3}, {"x^3", 2.5, 0.1}};
  page = ReportHtml(result);
  for (const char* words :
       {"<b>42.0 %</b> of the squared error", "The largest part (61.0 %) is where: in contact, v &lt; 0.",
        "− 1.25·v |v|", "+ 2.50·x^3", "does not identify its cause"})
    EXPECT_TRUE(Holds(page, words)) << words;
  EXPECT_FALSE(Holds(page, "No misfit remains"));
  EXPECT_FALSE(Holds(page, "x &gt; 1"));
}

TEST(Report, ComparesWithPublishedResultsSegmentBySegment) {
  Result result = test::ExampleResult(Verdict::kNamed);
  result.gap.before.rmse = 0.0812, result.gap.after.rmse = 0.0203;
  result.relative_before = 0.123, result.relative_after = 0.031;
  EXPECT_FALSE(Holds(ReportHtml(result), "Published results on these data"));
  result.published = {{"rms error of <another> model", 0.035, "a thesis"}};
  std::string page = ReportHtml(result);
  for (const char* words : {"rms error of &lt;another&gt; model</td><td class=\"num\">0.0350</td><td>a thesis",
                            "rms error 0.0812 → 0.0203 N, relative error 12.3 % → 3.1 %"})
    EXPECT_TRUE(Holds(page, words)) << words;
  EXPECT_FALSE(Holds(page, "Held-out segments"));
  result.gap.stretches = {{14.0, 17.0, 3000, 0.08, 0.021}};
  page = ReportHtml(result);
  EXPECT_TRUE(Holds(page,
                    "<tr><td>14.00</td><td>17.00</td><td class=\"num\">3000</td><td class=\"num\">0.0800</td>"
                    "<td class=\"num\">0.0210 N"));
}

TEST(Report, ComesOutOfAnEmptyResult) { EXPECT_TRUE(Holds(ReportHtml(Result{}), "</html>")); }

TEST(Report, ComesOutOfAResultWithoutANumber) {
  Result r = test::ExampleResult(Verdict::kNamed);
  const double nan = std::nan("");
  r.probability_none = r.probability_unnamed = r.dt = nan;
  r.gap.before = r.gap.after = {nan, nan, nan, nan, nan};
  r.gap.noise_floor = r.gap.closed_fraction = r.gap.closed_low = r.gap.closed_high = r.gap.gap_ratio = nan;
  r.effects[0].probability = r.effects[0].parameters[0].mean = r.effects[0].parameters[0].sd = nan;
  for (CandidateScore& c : r.candidates) c.probability = c.log_evidence = c.heldout_score = c.closed_fraction = nan;
  for (Where& w : r.where) w.share_of_excess = w.effect_size = w.p_value = nan;
  for (ParameterChange& p : r.parameters) p.before.mean = p.before.sd = p.after.mean = nan;
  for (double& y : r.figures.residual_before.y) y = std::numeric_limits<double>::infinity();
  r.figures.diagnosis_end_s = nan;
  const std::string html = ReportHtml(r);
  for (const char* number : {">nan", " nan", "-nan", ":nan", ">inf", ">-inf", " inf ", ":inf"})
    EXPECT_EQ(html.find(number), std::string::npos) << number;
}

}  // namespace
}  // namespace armcmc::gap::report_test
