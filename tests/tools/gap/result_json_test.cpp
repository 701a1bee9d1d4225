#include "armcmc/gap/result_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tools/gap/report_fixture.hpp"

namespace armcmc::gap::result_json_test {
namespace {

using nlohmann::json;

constexpr Verdict kVerdicts[] = {Verdict::kNone, Verdict::kNamed, Verdict::kAmbiguous, Verdict::kUnnamed};

TEST(ResultJson, HasEveryKeyForEveryVerdict) {
  for (const Verdict verdict : kVerdicts) {
    const json out = ToJson(test::ExampleResult(verdict));
    EXPECT_EQ(out.at("schema"), 1);
    EXPECT_EQ(out.at("verdict"), Name(verdict));
    for (const char* key : {"effects", "ambiguous_set", "candidates", "where", "aliases", "sparse", "notes"})
      EXPECT_TRUE(out.at(key).is_array()) << key;
    EXPECT_TRUE(out.at("separate_by").is_string());
    EXPECT_EQ(out.at("gap").at("unit"), "N");
    for (const char* key : {"heldout_rmse_before", "heldout_rmse_after", "noise_floor"})
      EXPECT_TRUE(out.at("gap").at(key).is_number()) << key;
    EXPECT_TRUE(out.at("gap").contains("closed_fraction"));
    EXPECT_TRUE(out.at("parameters").at("before").at("K").at("mean").is_number());
    EXPECT_TRUE(out.at("parameters").at("after").at("K").at("sd").is_number());
    EXPECT_TRUE(out.at("budget").contains("adjust_ms_before"));
    EXPECT_TRUE(out.at("budget").contains("adjust_ms_after"));
  }
}

TEST(ResultJson, NamesTheEffect) {
  const json effect = ToJson(test::ExampleResult(Verdict::kNamed)).at("effects").at(0);
  EXPECT_EQ(effect.at("name"), "coulomb_friction");
  EXPECT_EQ(effect.at("probability"), 0.991);
  EXPECT_EQ(effect.at("parameters").at("force"), (json{{"mean", 0.0801}, {"sd", 0.0007}, {"unit", "N"}}));
  EXPECT_EQ(effect.at("when"), "always");
  EXPECT_EQ(effect.at("family"), "dry friction");
  EXPECT_EQ(effect.at("formula"), "exact");
  EXPECT_EQ(effect.at("provisional"), false);
}

TEST(ResultJson, SaysWhatIsConfoundedAndWhatIsDetermined) {
  Result result = test::ExampleResult(Verdict::kNamed);
  EXPECT_EQ(ToJson(result).at("determined"), json::array());
  result.effects[0].parameters[0].confounded_with = {"pull"};
  result.determined = {{"force + pull", {"force", "pull"}, 20.0, 0.05, "N"}};
  const json out = ToJson(result);
  EXPECT_EQ(out.at("effects").at(0).at("parameters").at("force").at("confounded_with"), json::array({"pull"}));
  EXPECT_EQ(out.at("determined").at(0), (json{{"combination", "force + pull"},
                                              {"parameters", {"force", "pull"}},
                                              {"mean", 20.0},
                                              {"sd", 0.05},
                                              {"unit", "N"}}));
}

TEST(ResultJson, SaysWhenAnEffectActs) {
  Result result = test::ExampleResult(Verdict::kNamed);
  const auto when = [&](When::Kind kind) {
    result.effects[0].when = {kind, 4.25};
    return ToJson(result).at("effects").at(0).at("when");
  };
  EXPECT_EQ(when(When::Kind::kContact), "contact");
  EXPECT_EQ(when(When::Kind::kFree), "free");
  EXPECT_EQ(when(When::Kind::kFrom), (json{{"from_s", 4.25}}));
  EXPECT_EQ(when(When::Kind::kUntil), (json{{"until_s", 4.25}}));
}

TEST(ResultJson, MarksAnApproximateFormula) {
  Result result = test::ExampleResult(Verdict::kNamed);
  result.effects[0].approximate = true;
  EXPECT_EQ(ToJson(result).at("effects").at(0).at("formula"), "approximate");
}

TEST(ResultJson, ListsTheAlternativesAndTheExperiment) {
  const json out = ToJson(test::ExampleResult(Verdict::kAmbiguous));
  EXPECT_EQ(out.at("ambiguous_set"), (json{{"sensor_lag"}, {"sensor_delay"}}));
  EXPECT_NE(out.at("separate_by").get<std::string>().find("Tap the surface"), std::string::npos);
  EXPECT_NE(out.at("separate_by").get<std::string>().find("separate.toml"), std::string::npos);
}

TEST(ResultJson, KeepsTheNumbersOfCandidatesAndPlaces) {
  const json out = ToJson(test::ExampleResult(Verdict::kNamed));
  EXPECT_EQ(out.at("candidates").at(0).at("effects"), json{"coulomb_friction"});
  EXPECT_EQ(out.at("candidates").at(0).at("log_evidence"), 48211.3);
  EXPECT_EQ(out.at("candidates").at(0).at("heldout_score"), 9120.4);
  EXPECT_EQ(out.at("where").at(0).at("share_of_excess_error"), 0.91);
  EXPECT_EQ(out.at("where").at(0).at("region"), "v near 0, both signs");
  EXPECT_EQ(out.at("gap").at("heldout_rmse_before"), 0.0801);
  EXPECT_EQ(out.at("gap").at("heldout_rmse_after"), 0.0203);
}

TEST(ResultJson, DoesNotCallAnUnmeasuredTimeZero) {
  Result result = test::ExampleResult(Verdict::kNamed);
  result.budget = {};
  EXPECT_TRUE(ToJson(result).at("budget").at("adjust_ms_after").is_null());
}

bool AllFinite(const json& value) {
  if (value.is_number_float()) return std::isfinite(value.get<double>());
  if (!value.is_structured()) return true;
  return std::all_of(value.begin(), value.end(), AllFinite);
}

TEST(ResultJson, WritesNullForWhatIsNotFinite) {
  Result result = test::ExampleResult(Verdict::kNamed);
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  result.probability_none = nan;
  result.effects[0].parameters[0].sd = inf;
  result.candidates[0].log_evidence = -inf;
  result.where[0].p_value = nan;
  result.gap.closed_fraction = result.gap.before.rmse = nan;
  result.gap.modes[0].rmse_after = inf;
  result.parameters[0].after.mean = nan;
  result.budget.adjust_ms_after = inf;
  result.seconds[0].second = nan;
  const json out = ToJson(result);
  EXPECT_TRUE(AllFinite(out));
  EXPECT_TRUE(out.at("gap").at("closed_fraction").is_null());
  EXPECT_EQ(json::parse(out.dump()), out);
}

TEST(ResultJson, WritesValidTextWhateverTheNames) {
  Result result = test::ExampleResult(Verdict::kNamed);
  result.data_file =
      "/data/Kr\xE4"
      "fte \"quoted\".csv";
  result.notes = {"column \xFF"};
  result.where[0].feature = "a<b>\n";
  const json out = json::parse(ToJson(result).dump());
  EXPECT_EQ(out.at("data").at("file"), "/data/Kr�fte \"quoted\".csv");
  EXPECT_EQ(out.at("where").at(0).at("feature"), "a<b>\n");
}

TEST(ResultJson, TellsHowParametersDriftAndWhetherTheyCouldBeRefitted) {
  Result result = test::ExampleResult(Verdict::kNamed);
  EXPECT_EQ(ToJson(result).at("drift"), json::object());
  ParameterDrift& drift = result.drift.emplace_back();
  drift.name = "M", drift.unit = "kg";
  drift.before = {true, {"", {1.0, 3.0}, {90.0, 99.0}, {89.0, 98.0}, {91.0, 100.0}}, 94.0, 4.7, 1e-9, false};
  EXPECT_EQ(ToJson(result).at("drift"),
            (json{{"M",
                   {{"unit", "kg"},
                    {"before",
                     {{"mean", 94.0},
                      {"moves_by", 4.7},
                      {"p_value", 1e-9},
                      {"constant", false},
                      {"stretches",
                       {{{"t_s", 1.0}, {"value", 90.0}, {"low95", 89.0}, {"high95", 91.0}},
                        {{"t_s", 3.0}, {"value", 99.0}, {"low95", 98.0}, {"high95", 100.0}}}}}},
                    {"after", nullptr}}}}));
}

TEST(ResultJson, ScoresPredictionsOnePackAhead) {
  Result result = test::ExampleResult(Verdict::kNamed);
  EXPECT_TRUE(ToJson(result).at("one_step").is_null());
  result.run.done = true;
  result.run.pack_s = 0.1;
  result.run.before = {1000, 6.98, 0.774, 4.58};
  result.run.before_apart = {300, 7.5, 0.75, 4.6};
  result.run.after = {1000, 2.27, 0.947, 2.54};
  result.run.after_apart = {300, 2.5, 0.94, 2.6};
  json out = ToJson(result).at("one_step");
  EXPECT_EQ(out.at("unit"), "N");
  EXPECT_EQ(out.at("ahead_s"), 0.1);
  const json apart{{"samples", 300}, {"rmse", 7.5}, {"coverage95", 0.75}, {"half_width95", 4.6}};
  EXPECT_EQ(
      out.at("before"),
      (json{{"samples", 1000}, {"rmse", 6.98}, {"coverage95", 0.774}, {"half_width95", 4.58}, {"kept_apart", apart}}));
  EXPECT_TRUE(out.at("after").is_null()) << "nothing was named";
  result.run.has_after = true;
  out = ToJson(result).at("one_step");
  EXPECT_EQ(out.at("after").at("rmse"), 2.27);
  EXPECT_EQ(out.at("after").at("kept_apart").at("rmse"), 2.5);
}

TEST(ResultJson, ListsHeldOutSegmentsAndPublishedResults) {
  Result result = test::ExampleResult(Verdict::kNamed);
  result.gap.stretches = {{14.0, 17.0, 3000, 0.08, 0.021}};
  result.published = {{"rms error of another model", 0.035, "a thesis"}};
  const json out = ToJson(result);
  EXPECT_EQ(
      out.at("gap").at("stretches"),
      json::array(
          {{{"from_s", 14.0}, {"until_s", 17.0}, {"samples", 3000}, {"rmse_before", 0.08}, {"rmse_after", 0.021}}}));
  EXPECT_EQ(out.at("published"),
            json::array({{{"what", "rms error of another model"}, {"value", 0.035}, {"source", "a thesis"}}}));
}

}  // namespace
}  // namespace armcmc::gap::result_json_test
