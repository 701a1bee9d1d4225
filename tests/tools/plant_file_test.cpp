#include "armcmc/support/plant_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "support/paths.hpp"

namespace armcmc::support::plant_file_test {
namespace {

using expression::SymbolKind;
using testing::HasSubstr;

std::vector<std::filesystem::path> PlantsThatComeAlong() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(test::SourceDir() / "core/plants"))
    if (entry.is_directory()) paths.push_back(entry.path() / "plant.toml");
  return paths;
}

TEST(PlantFile, ThoseThatComeAlongAreUnderstoodAndNamedAsTheirFolder) {
  int count = 0;
  for (const auto& path : PlantsThatComeAlong()) {
    const Plant plant = ReadPlant(path);
    EXPECT_EQ(plant.description().name, path.parent_path().filename().string());
    ++count;
  }
  EXPECT_GE(count, 8);
}

TEST(PlantFile, IsWhatItSays) {
  const Plant plant = ReadPlant(test::SourceDir() / "core/plants/servo_axis/plant.toml");
  EXPECT_EQ(plant.description().signals.size(), 4u);
  EXPECT_EQ(plant.output(), 3);
  ASSERT_EQ(plant.modes().size(), 1u);
  EXPECT_EQ(plant.modes()[0].when, -1);
  const int mass = plant.NodeOf(SymbolKind::kParameter, 0);
  EXPECT_TRUE(plant.graph().DependsOn(plant.modes()[0].law, mass));
  EXPECT_EQ(*plant.description().parameters[2].lower, -80.0) << "8 sd below the mean";
  EXPECT_EQ(plant.SignalsWithRole("velocity"), std::vector<int>{1});

  const Plant actuator = ReadPlant(test::SourceDir() / "core/plants/soft_actuator/plant.toml");
  EXPECT_EQ(actuator.modes().size(), 3u);
  EXPECT_TRUE(actuator.modes()[2].passive);
  EXPECT_EQ(actuator.states().size(), 3u);
  EXPECT_GE(actuator.predicts(), 0);
}

/// The file below, with one text replaced by another.
std::string ErrorOf(const std::string& from, const std::string& to) {
  std::string text = R"(schema = 1
name = "axis"
output = "F"

[signals]
q = { unit = "m", role = "position" }
v = { unit = "m/s", role = "velocity", derivative_of = "q" }
a = { unit = "m/s^2", role = "acceleration", derivative_of = "v" }
F = { unit = "N", role = "force" }

[constants]
g = { value = 9.81, unit = "m/s^2" }

[parameters]
M = { unit = "kg", mean = 90.0, sd = 30.0, lower = 1.0, upper = 500.0 }
Fv = { unit = "N s/m", mean = 200.0, sd = 100.0 }
Fs = { unit = "N s/m", mean = 200.0, sd = 100.0 }

[let]
weight = "M*g"
drag = "Fv*v"

[[mode]]
name = "forward"
when = "v >= 0"
law = "M*a + drag + weight"

[[mode]]
name = "back"
law = "M*a + Fs*v"

[states]
speed = { unit = "m/s", start = "v", rate = "F/M" }

[report]
W = { unit = "N", value = "M*g" }

[noise]
std = 5.0
)";
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  try {
    (void)PlantFromText(text, "p.toml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(PlantFile, TheOneBelowIsRight) { EXPECT_EQ(ErrorOf("schema", "schema"), ""); }

struct Wrong {
  const char* from;
  const char* to;
  const char* place;
  const char* says;
};

class WrongPlantFile : public testing::TestWithParam<Wrong> {};

TEST_P(WrongPlantFile, IsToldWhereAndWhat) {
  const std::string said = ErrorOf(GetParam().from, GetParam().to);
  EXPECT_THAT(said, HasSubstr(std::string("p.toml:") + GetParam().place + ": "));
  EXPECT_THAT(said, HasSubstr(GetParam().says));
  EXPECT_EQ(said.find('\n'), std::string::npos) << "one line: " << said;
}

INSTANTIATE_TEST_SUITE_P(
    PlantFiles, WrongPlantFile,
    testing::Values(Wrong{"M*a + drag", "M*aa + drag", "26:10", "unknown name \"aa\" (did you mean a?)"},
                    Wrong{"\"Fv*v\"", "\"Fv*(v\"", "21:14", "to close"},
                    Wrong{"M*a + drag", "M*a + 3.5*q", "26:12",
                          "if 3.5 is in N/m, name it: [constants] NAME = { value = 3.5, unit = \"N/m\" }"},
                    Wrong{"M*a + drag", "M*a + q/0.5", "26:12", "if 0.5 is in m/N,"},
                    Wrong{"M*a + drag", "-2*q", "26:13", "if 2 is in N/m,"},
                    Wrong{"M*a + drag", "M*a + 3.5 N/m*q", "26:18",
                          "a number with a unit needs a name: [constants] NAME = { value = 3.5, unit = \"..\" }"},
                    Wrong{"M*a + drag", "M*a + (3.5 N/m)*q", "26:19", "a number with a unit needs a name"},
                    Wrong{"output = \"F\"", "output = \"G\"", "3:10", "no signal is called \"G\""},
                    Wrong{"sd = 30.0", "sd = -1.0", "15:38", "above 0"},
                    Wrong{"of = \"q\"", "of = \"v\"", "7:56", "a rate of itself"},
                    Wrong{"role = \"force\"", "role = \"force\", derivative_of = \"q\"", "9:51",
                          "the rate of q would be"},
                    Wrong{"role = \"force\"", "role = \"force\", between = \"hold\"", "9:45", "held"},
                    Wrong{"unit = \"kg\"", "unit = \"kgg\"", "15:15", "unknown unit \"kgg\""},
                    Wrong{"unit = \"kg\"", "unit = \"g\"", "26:12", "units do not match"},
                    Wrong{"M*a + Fs*v", "M*a + Fv*v", "17:6", "Fs is not used"},
                    Wrong{"M*a + Fs*v", "M*a + 0*Fs*v", "17:6", "no law depends on Fs"},
                    Wrong{"when = \"v >= 0\"", "when = \"v\"", "25:9", "condition"},
                    Wrong{"when = \"v >= 0\"", "when = \"v >= M\"", "25:11", "units do not match"},
                    Wrong{"when = \"v >= 0\"", "when = \"M >= 0\"", "25:9", "signals alone"},
                    Wrong{"weight = \"M*g\"", "weight = \"M*g + drag\"", "20:17", "further down"},
                    Wrong{"name = \"back\"", "name = \"forward\"", "29:8", "two modes"},
                    Wrong{"rate = \"F/M\"", "rate = \"F*M\"", "33:46", "the rate of speed is"},
                    Wrong{"start = \"v\"", "start = \"speed\"", "33:34", "not on states"},
                    Wrong{"value = \"M*g\"", "value = \"M*a\"", "36:28", "parameters and constants"},
                    Wrong{"value = \"M*g\"", "value = \"M\"", "36:28", "expected N"},
                    Wrong{"std = 5.0", "std = 0", "39:7", "number"},
                    Wrong{"lower = 1.0", "lower = 1e3", "15:5", "lower is not below upper"},
                    Wrong{"Fs = {", "sin = {", "17:7", "cannot be a name"},
                    Wrong{"Fs = {", "v = {", "17:5", "something else"},
                    Wrong{"Fs = {", "t = {", "17:5", "plant's time"},
                    Wrong{"name = \"axis\"", "name = \"My axis\"", "2:8", "lower-case letters"},
                    Wrong{"derivative_of = \"q\"", "derivative = \"q\"", "7:53", "did you mean derivative_of?"},
                    Wrong{"schema = 1", "schema = 2", "1:10", "schema"},
                    Wrong{"schema = 1", "schema = 1\nlaw = \"M*a\"", "2:7", "either a law or modes"},
                    Wrong{"schema = 1", "schema 1", "1:8", "="}),
    [](const auto& info) { return "n" + std::to_string(info.index); });

TEST(Plant, FingerprintIsThatOfItsSignals) {
  const auto with = [](const char* unit, const char* mean) {
    return PlantFromText(
               std::string("schema = 1\nname = \"a\"\noutput = \"F\"\nlaw = \"K*x\"\n[signals]\nx = { unit = \"") +
                   unit + "\" }\nF = { unit = \"N\" }\n[parameters]\nK = { unit = \"1\", mean = " + mean +
                   ", sd = 1.0 }\n[noise]\nstd = 1.0\n",
               "a.toml")
        .fingerprint();
  };
  EXPECT_EQ(with("N", "1.0"), with("N", "2.0"));
  EXPECT_NE(with("N", "1.0"), with("kg m/s^2", "1.0"));
}

}  // namespace
}  // namespace armcmc::support::plant_file_test
