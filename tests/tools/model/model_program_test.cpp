// armcmc-model as a user runs it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <regex>
#include <sstream>
#include <string>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::model::model_program_test {
namespace {

using testing::HasSubstr;

class ModelProgram : public ::testing::Test {
 protected:
  test::Outcome Run(const std::vector<std::string>& arguments) const {
    return test::RunProgram(test::Program("armcmc-model"), arguments, std::chrono::minutes(1), dir_.path());
  }
  std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(dir_.path() / name) << text;
    return name;
  }
  test::ScratchDir dir_;
};

/// A right plant file, to be spoilt.
std::string AxisText() {
  std::ifstream file(test::SourceDir() / "core/plants/servo_axis/plant.toml");
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(ModelProgram, SaysWhatItUnderstoodOfEveryPlantThatComesAlong) {
  const test::Outcome list = Run({"list"});
  EXPECT_EQ(list.code, 0) << list.err;
  for (const auto& entry : std::filesystem::directory_iterator(test::SourceDir() / "core/plants")) {
    if (!entry.is_directory()) continue;  // the page about plants
    const std::string name = entry.path().filename().string();
    EXPECT_THAT(list.out, HasSubstr(name));
    const test::Outcome check = Run({"check", name});
    EXPECT_EQ(check.code, 0) << check.err;
    EXPECT_THAT(check.out, HasSubstr(name + ": "));
    EXPECT_THAT(check.out, HasSubstr("noise: "));
    EXPECT_THAT(check.out, testing::Not(HasSubstr("note: ")));
  }
}

TEST_F(ModelProgram, ShowsSignalsPriorsAndTheLawOfAFile) {
  const test::Outcome check = Run({"check", Write("axis.toml", AxisText())});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_TRUE(std::regex_search(check.out, std::regex("F  \\(output\\) +N +force")));
  EXPECT_TRUE(std::regex_search(check.out, std::regex("v +m/s +velocity +rate of q")));
  EXPECT_TRUE(std::regex_search(check.out, std::regex("off +N +0 \\+- 10 +-80 +80"))) << check.out;
  EXPECT_TRUE(std::regex_search(check.out, std::regex("always +F +N +M\\*a \\+ Fv\\*v \\+ off"))) << check.out;
  EXPECT_THAT(check.out, HasSubstr("the estimator samples M, Fv, off\n"));
}

TEST_F(ModelProgram, SaysWhereAPowerMayBeNoNumber) {
  const auto checked = [this](const std::string& law) {
    std::string text = AxisText();
    const std::string from = "M*a + Fv*v + off";
    text.replace(text.find(from), from.size(), law);
    return Run({"check", Write("axis.toml", text)}).out;
  };
  EXPECT_THAT(checked("M*a + Fv*v*(off/(Fv*v))^1.5"),
              HasSubstr("note: axis.toml:5:31: law = \"M*a + Fv*v*(off/(Fv*v))^1.5\": the base of this power can be"));
  for (const char* law : {"M*a + Fv*v*(off/(Fv*v))^2", "M*a + Fv*v*max(off/(Fv*v), 0)^1.5"}) {
    const std::string said = checked(law);
    EXPECT_THAT(said, HasSubstr("noise: ")) << law;
    EXPECT_THAT(said, testing::Not(HasSubstr("note: "))) << law;
  }
}

struct Wrong {
  const char* name;
  const char* from;
  const char* to;
  const char* expected;  ///< What the one line holds.
};

class WrongFile : public ModelProgram, public ::testing::WithParamInterface<Wrong> {};

TEST_P(WrongFile, EndsWithOneLineThatSaysWhere) {
  std::string text = AxisText();
  const std::string from = GetParam().from;
  ASSERT_NE(text.find(from), std::string::npos);
  text.replace(text.find(from), from.size(), GetParam().to);
  const test::Outcome check = Run({"check", Write("wrong.toml", text)});
  EXPECT_EQ(check.code, 2);
  EXPECT_EQ(std::count(check.err.begin(), check.err.end(), '\n'), 1) << check.err;
  EXPECT_THAT(check.err, HasSubstr(GetParam().expected));
  EXPECT_EQ(check.out, "");
}

INSTANTIATE_TEST_SUITE_P(
    Axis, WrongFile,
    ::testing::Values(Wrong{"UnknownName", "M*a", "M*aa", "wrong.toml:5:10"},
                      Wrong{"OpenParenthesis", "Fv*v", "Fv*(v", "wrong.toml:5:"},
                      Wrong{"OutputThatIsNoSignal", "output = \"F\"", "output = \"G\"", "wrong.toml:4:"},
                      Wrong{"NegativeSpread", "sd = 30.0", "sd = -1.0", "wrong.toml:14:"},
                      Wrong{"CycleOfDerivatives", "derivative_of = \"q\"", "derivative_of = \"v\"", "wrong.toml:9:"},
                      Wrong{"UnitThatDoesNotFit", "Fv*v", "Fv*q", "wrong.toml:5:"},
                      Wrong{"UnitThatIsNone", "\"N s/m\"", "\"N sec/m\"", "wrong.toml:15:"},
                      Wrong{"UnusedParameter", " + off", "", "wrong.toml:16:"},
                      Wrong{"Arity", "Fv*v", "Fv*clamp(v, 0)", "wrong.toml:5:"},
                      Wrong{"KeyThatIsMistyped", "estimate = true", "estimat = true",
                            "wrong.toml:21:11: noise.estimat: unknown key (did you mean estimate?)"}),
    [](const auto& at) { return std::string(at.param.name); });

TEST_F(ModelProgram, WritesAStartThatIsUnderstoodAndOverwritesNothing) {
  const test::Outcome made = Run({"new", "my_pendulum", "--from", "pendulum"});
  ASSERT_EQ(made.code, 0) << made.err;
  const test::Outcome check = Run({"check", "my_pendulum.toml"});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("my_pendulum: Driven pendulum"));
  const test::Outcome again = Run({"new", "my_pendulum"});
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.err, HasSubstr("already exists"));
  EXPECT_EQ(Run({"new", "My plant"}).code, 2);
}

TEST_F(ModelProgram, TakesALimitThatIsPassedForAnErrorOfTheFile) {
  // Eight parameters and the noise scale.
  std::string text = AxisText();
  std::string law = "M*a + Fv*v + off", parameters;
  for (const char* name : {"c1", "c2", "c3", "c4", "c5"}) {
    law += " + " + std::string(name);
    parameters += std::string(name) + " = { unit = \"N\", mean = 0.0, sd = 1.0 }\n";
  }
  text.replace(text.find("M*a + Fv*v + off"), std::string("M*a + Fv*v + off").size(), law);
  text.insert(text.find("[noise]"), parameters);
  const test::Outcome check = Run({"check", Write("large.toml", text)});
  EXPECT_EQ(check.code, 2);
  EXPECT_THAT(check.err, HasSubstr("large.toml:13:"));
  EXPECT_THAT(check.err, HasSubstr("at most 8 are possible"));
}

TEST_F(ModelProgram, NamesTheNearestPlantOfANameThatIsNone) {
  const test::Outcome check = Run({"check", "servo_axes"});
  EXPECT_EQ(check.code, 2);
  EXPECT_THAT(check.err, HasSubstr("servo_axis"));
}

/// 20 s of an axis of 100 kg, 180 N s/m, -3 N, whose speed is `speed(t)`; columns t, q, v, a, F.
template <class Speed>
std::string AxisCsv(Speed speed) {
  std::ostringstream csv;
  csv.precision(12);
  csv << "t,q,v,a,F\n";
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 1.0);
  double q = 0.0;
  for (int n = 0; n < 2000; ++n) {
    const double t = 0.01 * n, v = speed(t), a = (speed(t + 1e-4) - speed(t - 1e-4)) / 2e-4;
    q += 0.01 * v;
    csv << t << ',' << q << ',' << v << ',' << a << ',' << 100.0 * a + 180.0 * v - 3.0 + noise(random) << '\n';
  }
  return csv.str();
}

TEST_F(ModelProgram, SaysWhatAStepCosts) {
  const test::Outcome axis = Run({"check", "servo_axis"}), tanks = Run({"check", "two_tanks"});
  EXPECT_TRUE(std::regex_search(axis.out, std::regex("costs: 2 operations a candidate and sample; "))) << axis.out;
  EXPECT_TRUE(std::regex_search(axis.out, std::regex("step: [0-9.]+ ms on this computer for 14979 draws"))) << axis.out;
  EXPECT_TRUE(std::regex_search(tanks.out, std::regex("and [1-9][0-9]+ for the states"))) << tanks.out;
}

TEST_F(ModelProgram, SaysThatRichDataTellEveryParameter) {
  const std::string csv =
      Write("rich.csv", AxisCsv([](double t) { return 0.2 * std::sin(2.0 * t) + 0.05 * std::sin(7.0 * t); }));
  const test::Outcome check = Run({"check", "servo_axis", "--data", csv});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("These data identify M, Fv and off.\n"));
  EXPECT_TRUE(std::regex_search(check.out, std::regex("M +kg +(99|100)[.0-9]* \\+- 0\\.[0-9]+ +yes"))) << check.out;
  EXPECT_THAT(check.out, HasSubstr("over these data"));
}

TEST_F(ModelProgram, SaysWhereDataContradictWhatAnInputDoesBetweenSamples) {
  // x' = u - c x with c = 3, and u a command that jumps at samples.
  const auto plant = [](const char* between) {
    return std::string(
               "schema = 1\nname = \"tank\"\noutput = \"y\"\nlaw = \"x\"\n[signals]\n"
               "u = { unit = \"1/s\", between = \"") +
           between +
           "\" }\ny = { unit = \"1\" }\n[parameters]\nc = { unit = \"1/s\", mean = 2.0, sd = 2.0, lower = 0.0 }\n"
           "[states]\nx = { unit = \"1\", start = \"y\", rate = \"u - c*x\" }\n[noise]\nstd = 0.01\n";
  };
  std::ostringstream csv;
  csv.precision(12);
  csv << "t,u,y\n";
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 0.01);
  double x = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const double u = std::sin(0.4 * n) + std::cos(1.1 * n);
    csv << 0.05 * n << ',' << u << ',' << x + noise(random) << '\n';
    x = u / 3.0 + (x - u / 3.0) * std::exp(-0.15);
  }
  const std::string data = Write("tank.csv", csv.str());
  const test::Outcome linear = Run({"check", Write("linear.toml", plant("linear")), "--data", data});
  EXPECT_THAT(linear.out, HasSubstr("between samples: u with between = \"held\" explains these data better, by "));
  const test::Outcome held = Run({"check", Write("held.toml", plant("held")), "--data", data});
  EXPECT_EQ(held.code, 0) << held.err;
  EXPECT_EQ(held.out.find("between samples:"), std::string::npos) << held.out;
}

TEST_F(ModelProgram, SaysWhichParametersNothingInTheDataDependsOnAndWhichMakeUpForOthers) {
  // At constant speed nothing depends on the mass, and friction is as good as an offset.
  const test::Outcome check =
      Run({"check", Write("axis.toml", AxisText()), "--data", Write("slow.csv", AxisCsv([](double) { return 0.2; }))});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("not M: hardly anything in them depends on it"));
  EXPECT_THAT(check.out, HasSubstr("not off: it moves against Fv"));
  EXPECT_THAT(check.out, HasSubstr("not Fv: it moves against off"));
}

TEST_F(ModelProgram, ARecordingOfOtherSignalsIsRefused) {
  (void)Write("rich.csv", AxisCsv([](double t) { return 0.2 * std::sin(t); }));
  const std::string recording = Write("rec.toml",
                                      "schema = 1\nmodel = \"servo_axis\"\nfile = \"rich.csv\"\n[columns]\n"
                                      "t = { column = \"t\" }\nq = { column = \"q\" }\nF = { column = \"F\" }\n");
  EXPECT_EQ(Run({"check", "servo_axis", "--data", recording}).code, 0);
  const test::Outcome other = Run({"check", "pendulum", "--data", recording});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr("servo_axis"));
  EXPECT_EQ(std::count(other.err.begin(), other.err.end(), '\n'), 1);
}

}  // namespace
}  // namespace armcmc::model::model_program_test
