// A plant that nobody compiled, replayed from its file and a CSV.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "armcmc/data_pack_v2_t.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/support/model_file.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/replay_data.hpp"

namespace armcmc::replay::replay_plant_file_test {
namespace {

using testing::HasSubstr;

constexpr double kMass = 95.0, kViscous = 203.0, kOffset = -3.0;

class ReplayOfAPlantFile : public ::testing::Test {
 protected:
  /// A sum of sines, its force with noise of 1 N.
  /// @param position  Name of its column. @param hum  Amplitude of what the law lacks, at 7.3 Hz, N.
  void WriteMotion(const std::string& name, const std::string& position, double dt, int rows, double hum = 0.0) const {
    std::ofstream file(dir_ / name);
    file << "t," << position << ",F\n";
    file.precision(15);
    std::mt19937_64 generator(11);
    std::normal_distribution<double> noise(0.0, 1.0);
    for (int n = 0; n < rows; ++n) {
      const double t = n * dt;
      double q = 0.0, v = 0.0, a = 0.0;
      for (const double w : {0.003 / dt, 0.01 / dt}) {
        const double size = 0.1 * std::pow(0.003 / dt / w, 2);
        q += size * std::sin(w * t), v += size * w * std::cos(w * t), a -= size * w * w * std::sin(w * t);
      }
      file << t << ',' << q << ','
           << kMass * a + kViscous * v + kOffset + hum * std::sin(2.0 * M_PI * 7.3 * t) + noise(generator) << '\n';
    }
  }

  test::Outcome Replay(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--out", (dir_ / "estimates.csv").string()});
    return test::RunProgram(test::Program("armcmc-replay"), arguments, std::chrono::minutes(2), dir_.path());
  }

  /// Last row of the estimates, by column. @param before  Rows that come after it.
  [[nodiscard]] std::map<std::string, double> Last(std::size_t before = 0) const {
    std::ifstream file(dir_ / "estimates.csv");
    std::vector<std::string> lines;  // the header first
    for (std::string line; std::getline(file, line);)
      if (!line.empty() && line[0] != '#') lines.push_back(line);
    if (lines.size() < 2 + before) return {};
    std::map<std::string, double> row;
    std::istringstream names(lines[0]), values(lines[lines.size() - 1 - before]);
    for (std::string name, value; std::getline(names, name, ',') && std::getline(values, value, ',');)
      row[name] = std::strtod(value.c_str(), nullptr);
    return row;
  }

  void ExpectTheTruth() const {
    const auto last = Last(), before = Last(1);
    for (const auto& [name, truth] : {std::pair{"M", kMass}, {"Fv", kViscous}, {"off", kOffset}}) {
      const double half = 0.5 * (last.at(std::string(name) + "_q975") - last.at(std::string(name) + "_q025"));
      EXPECT_GT(half, 0.0) << name;
      EXPECT_NEAR(last.at(std::string(name) + "_q50"), truth, 2.5 * half) << name;
      EXPECT_NEAR(last.at(name), truth, 2.5 * half) << name;
      EXPECT_NEAR(before.at(name), truth, 2.5 * half) << name;
    }
  }

  test::ScratchDir dir_;
};

TEST_F(ReplayOfAPlantFile, FindsTheParametersWithVelocityAndAccelerationMadeFromThePosition) {
  std::ofstream(dir_ / "my_axis.toml") << R"(schema = 1
name = "my_axis"
output = "F"
law = "M*acc + Fv*vel + off"

[signals]
acc = { unit = "m/s^2", role = "acceleration", derivative_of = "vel" }
vel = { unit = "m/s", role = "velocity", derivative_of = "pos" }
pos = { unit = "m", role = "position" }
F = { unit = "N", role = "force" }

[parameters]
M = { unit = "kg", mean = 50.0, sd = 50.0, lower = 1.0, upper = 500.0 }
Fv = { unit = "N s/m", mean = 100.0, sd = 200.0, lower = 0.0, upper = 2000.0 }
off = { unit = "N", mean = 0.0, sd = 10.0 }

[noise]
std = 1.0
estimate = true
)";
  WriteMotion("motion.csv", "pos", 1e-3, 3001);
  const test::Outcome run = Replay({"--model", "my_axis.toml", "--data", "motion.csv"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("30 packs (3 s)"));
  EXPECT_THAT(run.out, HasSubstr("column acc is missing: derived from vel, "));
  ExpectTheTruth();
}

TEST_F(ReplayOfAPlantFile, TakesAPlantThatCameAlongByItsName) {
  WriteMotion("motion.csv", "q", 1e-3, 2001);
  const test::Outcome run = Replay({"--model", "servo_axis", "--data", "motion.csv"});
  ASSERT_EQ(run.code, 0) << run.err;
  ExpectTheTruth();
}

TEST_F(ReplayOfAPlantFile, SaysWhereParametersSeemToChangeAllTheTime) {
  WriteMotion("motion.csv", "q", 1e-3, 2001);
  EXPECT_THAT(Replay({"--model", "servo_axis", "--data", "motion.csv"}).out, testing::Not(HasSubstr("just changed")));
  WriteMotion("motion.csv", "q", 1e-3, 2001, 60.0);
  EXPECT_THAT(Replay({"--model", "servo_axis", "--data", "motion.csv"}).out,
              testing::ContainsRegex("note: [0-9]+ of 20 packs look as if the parameters had just changed: the law may "
                                     "be missing something"));
}

TEST_F(ReplayOfAPlantFile, MakesPacksOfAHundredSamplesOfASlowRecording) {
  WriteMotion("slow.csv", "q", 0.05, 1001);
  const test::Outcome run = Replay({"--model", "servo_axis", "--data", "slow.csv"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("10 packs (50 s)"));
}

TEST_F(ReplayOfAPlantFile, SaysWhyThereIsNoVerdictAboutAGap) {
  WriteMotion("motion.csv", "q", 1e-3, 1001);
  std::ofstream(dir_ / "off.toml") << "schema = 1\n[model]\nname = \"servo_axis\"\n[gap_watch]\nenabled = false\n";
  EXPECT_THAT(Replay({"--config", "off.toml", "--data", "motion.csv"}).out,
              HasSubstr("gap between model and plant: not watched, since [gap_watch] enabled = false; armcmc-gap"));
  std::ofstream file(dir_ / "modes.toml");
  file << "schema = 1\nname = \"modes\"\noutput = \"F\"\n[signals]\nq = { unit = \"m\", role = \"position\" }\n"
          "v = { unit = \"m/s\", role = \"velocity\", derivative_of = \"q\" }\n"
          "a = { unit = \"m/s^2\", role = \"acceleration\", derivative_of = \"v\" }\n"
          "F = { unit = \"N\", role = \"force\" }\n[parameters]\n"
          "M = { unit = \"kg\", mean = 90.0, sd = 30.0, per_mode = true }\n"
          "Fv = { unit = \"N s/m\", mean = 200.0, sd = 100.0, per_mode = true }\n"
          "off = { unit = \"N\", mean = 0.0, sd = 10.0, per_mode = true }\n[noise]\nstd = 1.0\n";
  for (const char* mode : {"ahead\"\nwhen = \"v > 0.1", "back\"\nwhen = \"v < -0.1", "slow"})
    file << "[[mode]]\nname = \"" << mode << "\"\nlaw = \"M*a + Fv*v + off\"\n";
  file.close();
  EXPECT_THAT(Replay({"--model", "modes.toml", "--data", "motion.csv"}).out,
              HasSubstr("not watched, since there are more than 8 parameters in all modes together; armcmc-gap"));
}

/// The packs of a CSV as a log holds them.
void WriteLog(const std::filesystem::path& path, const SourceRequest& csv, const std::string& plant) {
  LogWriter log(path);
  const auto source = OpenSource(csv);
  for (RecordedPack next; source->Next(&next);) {
    data_pack_v2_t message{};
    const DataPack& pack = next.pack;
    message.seq = pack.seq;
    message.run_id = pack.run_id;
    message.t_last_ns = pack.t_last_ns;
    message.t_last_s = pack.t_last_s;
    message.dt = pack.dt;
    std::copy(plant.begin(), plant.end(), message.plant);
    message.fingerprint = static_cast<std::int64_t>(pack.fingerprint);
    message.n_samples = pack.num_samples;
    message.n_inputs = pack.num_inputs;
    for (std::size_t n = 0; n < static_cast<std::size_t>(pack.num_samples); ++n) {
      message.y[n] = pack.y[n];
      std::copy_n(pack.u[n].begin(), pack.num_inputs, message.u[n]);
    }
    log.Write("PLANT_PACK_V2", message);
  }
}

std::string TextOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST_F(ReplayOfAPlantFile, ALogGivesWhatTheCsvOfItsSamplesGives) {
  WriteMotion("motion.csv", "q", 1e-3, 1000);
  SourceRequest csv;
  csv.data = dir_ / "motion.csv";
  csv.plant = PlantNumber::kDescribed;
  csv.described = support::DescribedPlant((test::SourceDir() / "core/plants/servo_axis/plant.toml").string());
  csv.num_inputs = csv.described->info().num_inputs;
  csv.period = 0.0;
  WriteLog(dir_ / "axis.lcm", csv, "servo_axis");
  ASSERT_EQ(Replay({"--model", "servo_axis", "--data", "motion.csv"}).code, 0);
  const std::string from_csv = TextOf(dir_ / "estimates.csv");
  // The plant came along, so that its name in the log is enough.
  const test::Outcome run = Replay({"--data", "axis.lcm"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("model: servo_axis, by the plant of the log"));
  EXPECT_THAT(run.out, HasSubstr("10 packs (1 s)"));
  EXPECT_EQ(TextOf(dir_ / "estimates.csv"), from_csv);

  const test::Outcome other = Replay({"--model", "oscillator", "--data", "axis.lcm"});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.out, HasSubstr("rejected 10: pack of another plant"));
  WriteLog(dir_ / "mine.lcm", csv, "my_own");
  const test::Outcome unknown = Replay({"--data", "mine.lcm"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("holds packs of my_own, a plant that a file describes: say --model FILE"));
}

TEST_F(ReplayOfAPlantFile, IsComparedByItsOwnNamesAndUnits) {
  WriteMotion("motion.csv", "q", 1e-3, 1001);
  std::ofstream(dir_ / "config.toml") << "schema = 1\n[model]\nname = \"servo_axis\"\n[noise]\nkind = \"laplace\"\n";
  const test::Outcome run = Replay({"--model", "servo_axis", "--data", "motion.csv", "--compare", "config.toml"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("A: model servo_axis\n"));
  EXPECT_THAT(run.out, HasSubstr("B: config.toml, model servo_axis\n"));
  EXPECT_THAT(run.out, HasSubstr("residual of the output F, rms, N"));
}

TEST_F(ReplayOfAPlantFile, SaysWhatIsWrong) {
  WriteMotion("motion.csv", "position", 1e-3, 201);
  const test::Outcome column = Replay({"--model", "servo_axis", "--data", "motion.csv"});
  EXPECT_EQ(column.code, 2);
  EXPECT_THAT(column.err, HasSubstr("column q is missing"));
  const test::Outcome calibrate =
      Replay({"--model", "servo_axis", "--data", "motion.csv", "--calibrate", "calibrated.toml"});
  EXPECT_EQ(calibrate.code, 2);
  EXPECT_THAT(calibrate.err, HasSubstr("--calibrate needs --config"));
  std::ofstream(dir_ / "config.toml") << "schema = 1\n[model]\nname = \"servo_axis\"\n[model.parameters.M]\nsd = 3.0\n";
  const test::Outcome prior = Replay({"--config", "config.toml", "--data", "motion.csv"});
  EXPECT_EQ(prior.code, 2);
  EXPECT_THAT(prior.err, HasSubstr("config.toml:4:1: model.parameters"));
  EXPECT_THAT(prior.err, HasSubstr("stands in the plant's file"));
}

}  // namespace
}  // namespace armcmc::replay::replay_plant_file_test
