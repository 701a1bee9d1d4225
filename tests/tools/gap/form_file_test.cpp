// Effects from files: what a formula comes to, what the catalogue lends, and what is said of a file that is wrong.

#include "armcmc/gap/form_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "armcmc/support/strict_toml.hpp"

namespace armcmc::gap::form_file_test {
namespace {

constexpr double kDt = 1e-3;
constexpr Eigen::Index kRows = 1300;  // more than two blocks, and none that is full at the end

Signals Made() {
  Signals s;
  s.dt = kDt;
  s.t = Vector::LinSpaced(kRows, 2.0, 2.0 + kDt * (kRows - 1));
  s.origin = s.t[0];
  s.duration = s.t[kRows - 1] - s.t[0];
  s.at(Role::kPosition) = (7.0 * s.t.array()).sin();
  s.at(Role::kVelocity) = 7.0 * (7.0 * s.t.array()).cos();
  s.at(Role::kAcceleration) = -49.0 * s.at(Role::kPosition);
  s.at(Role::kPressure) = 2.0 + s.t.array();
  s.at(Role::kOpening) = (3.0 * s.t.array()).cos();
  s.scale = {0.7, 5.0, 35.0, 4.0, 0.7};
  s.output = s.at(Role::kPosition);
  s.output_scale = 2.0;
  s.active = (s.at(Role::kPosition).array() > 0.0).cast<double>();
  return s;
}

/// The only form of a file with these lines.
EffectForm Form(const std::string& lines, const Signals& s, const std::map<std::string, double>& constants = {}) {
  const std::string head = "schema = 1\n[[form]]\neffect = \"made\"\nfamily = \"made\"\ntext = \"made\"\n";
  return FormsFromText(head + lines, "made.toml", s, constants).at(0);
}

std::string MessageOf(const std::string& lines) {
  try {
    (void)Form(lines, Made());
  } catch (const support::ConfigError& error) {
    return error.what();
  }
  return "nothing is wrong";
}

constexpr const char* kAmplitude =
    "amplitudes = [{ name = \"force\", unit = \"N\", size = \"3*output\", positive = true }]\n";

TEST(FormFile, AFormulaGivesOneColumnForEachAmplitudeInItsSize) {
  const Signals s = Made();
  const EffectForm form = Form(
      "slot = \"output\"\nformula = \"(force + excess*exp(-(v/reach)^2))*tanh(v/speed)\"\n"
      "amplitudes = [{ name = \"force\", unit = \"N\", size = \"3*output\" }, { name = \"excess\", unit = \"N\" }]\n"
      "shapes = [{ name = \"speed\", unit = \"m/s\", size = \"v\", from = 0.1, to = 0.4 },\n"
      "          { name = \"reach\", unit = \"m/s\", size = \"v\", lower = 0.1, upper = 2 }]\nstarts = [2, 3]\n",
      s);
  ASSERT_EQ(form.num_amplitudes, 2);
  EXPECT_EQ(form.starts.size(), 6U);
  EXPECT_TRUE(form.coordinates[2].logarithmic);
  EXPECT_FALSE(form.coordinates[3].logarithmic);
  const std::array<double, 2> shape{std::log(0.2), 0.5};
  const Matrix columns = form.features(s, shape.data());
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double v = s.at(Role::kVelocity)[i], direction = std::tanh(v / (0.2 * 5.0));
    ASSERT_NEAR(columns(i, 0), 6.0 * direction, 1e-13) << i;
    ASSERT_NEAR(columns(i, 1), std::exp(-std::pow(v / 2.5, 2)) * direction, 1e-14) << i;
  }
}

TEST(FormFile, AStateOfALinearRateMovesExactly) {
  // A bristle of the catalogue's friction: the textbook's step from sample to sample.
  const Signals s = Made();
  const EffectForm form =
      Form(std::string("slot = \"output\"\ntakes = \"presliding_friction\"\n"
                       "with = { Fc = \"force\", s0 = \"0.5*distance\" }\n") +
               kAmplitude + "shapes = [{ name = \"distance\", unit = \"m\", from = 0.1, to = 1 }]\nstarts = [1]\n",
           s);
  const double shape = std::log(0.3);
  const Matrix column = form.features(s, &shape);
  double z = 0.0;
  for (Eigen::Index i = 1; i < kRows; ++i) {
    const double v = s.at(Role::kVelocity)[i], end = v > 0.0 ? 1.0 : -1.0;
    z = end + (z - end) * std::exp(-std::abs(v) * kDt / 0.15);
    ASSERT_NEAR(column(i, 0), 6.0 * z, 1e-12) << i;
  }
}

TEST(FormFile, AStateMayJumpAndAnInputBeLate) {
  const Signals s = Made();
  const EffectForm play = Form(
      "slot = \"drive\"\nstates.at = { start = \"u\", next = \"clamp(at, u - width, u + width)\" }\nformula = \"at\"\n"
      "shapes = [{ name = \"width\", unit = \"-\", from = 0.01, to = 1 }]\nstarts = [2]\n",
      s);
  const EffectForm late = Form(
      "slot = \"drive\"\ntakes = \"input_delay\"\nshapes = [{ name = \"tau\", unit = \"s\", from = 1e-4, to = 1 "
      "}]\nstarts = [2]\n",
      s);
  const double width = std::log(0.2), tau = std::log(2.25e-3);
  const Vector& u = s.at(Role::kOpening);
  const Matrix played = play.features(s, &width), delayed = late.features(s, &tau);
  double at = u[0];
  for (Eigen::Index i = 1; i < kRows; ++i) {
    at = std::clamp(at, u[i] - 0.2, u[i] + 0.2);
    ASSERT_NEAR(played(i, 0), at - u[i], 1e-14) << i;
    const double late_by = 0.75 * u[std::max<Eigen::Index>(i - 2, 0)] + 0.25 * u[std::max<Eigen::Index>(i - 3, 0)];
    ASSERT_NEAR(delayed(i, 0), late_by - u[i], 1e-13) << i;
  }
}

TEST(FormFile, AFilterActsOnWhatItIsGivenAndPreviousIsOneSampleBack) {
  const Signals s = Made();
  const EffectForm form =
      Form(std::string("slot = \"elastic\"\nformula = \"force*(law - previous(law))/dt\"\n") + kAmplitude, s);
  const Vector series = s.t.array().square();
  const Vector filtered = form.filter(s, series, 0, nullptr);
  EXPECT_EQ(filtered[0], 0.0);
  for (Eigen::Index i = 1; i < kRows; ++i) ASSERT_NEAR(filtered[i], 6.0 * (s.t[i] + s.t[i - 1]), 1e-9) << i;
}

TEST(FormFile, DriftsCountFromTheOriginOfTheRecordingAtHand) {
  const Signals s = Made();
  const EffectForm form =
      Form(std::string("slot = \"output\"\ntakes = \"output_drift\"\nwith = { r = \"force\" }\n") + kAmplitude, s);
  Signals later = s;
  later.origin = 2.5;
  EXPECT_NEAR(form.features(s, nullptr)(100, 0), 6.0 * 0.1, 1e-12);
  EXPECT_NEAR(form.features(later, nullptr)(100, 0), 6.0 * (0.1 - 0.5), 1e-12);
}

TEST(FormFile, AForceOfAMotionRemembers) {
  // Hysteresis of the catalogue, rising from rest and falling back: z' = v (1 - |z|) / s0 while loading, v / s0 after.
  const Signals s = Made();
  const EffectForm form =
      Form(std::string("slot = \"rate\"\ntakes = \"hysteresis\"\nwith = { Fh = \"force\", s0 = \"gear*reach\" }\n") +
               kAmplitude + "shapes = [{ name = \"reach\", unit = \"rad\", from = 0.1, to = 1 }]\nstarts = [1]\n",
           s, {{"gear", 2.0}});
  ASSERT_TRUE(form.remember);
  const std::array<double, 2> values{5.0, 0.4};
  std::array<double, kForceMemory> memory{};
  Motion motion{0.0, kDt, 0.0, 3.0, 0.0, 0.0};
  for (int i = 0; i < 200; ++i) form.remember(motion, values.data(), memory.data());
  const double loaded = 1.0 - std::exp(-3.0 * 200.0 * kDt / 0.8);
  // The first step from z = 0, where the slope jumps, is that of half the slope.
  EXPECT_NEAR(form.force(motion, values.data(), memory.data()), -5.0 * loaded, 5.0 * std::pow(3.0 * kDt / 0.8, 2));
  motion.rate = -3.0;
  const double before = memory[0];
  for (int i = 0; i < 50; ++i) form.remember(motion, values.data(), memory.data());
  EXPECT_NEAR(memory[0], before - 3.0 * 50.0 * kDt / 0.8, 1e-12);
}

TEST(FormFile, ABoundBeyondWhichItIsAnotherEffectIsOnEitherSideOrOnBoth) {
  const auto shape_with = [](const std::string& stop) {
    return Form(std::string("slot = \"output\"\nformula = \"force*tanh(v/speed)\"\n") + kAmplitude +
                    "shapes = [{ name = \"speed\", unit = \"m/s\", from = 0.1, to = 1" + stop + " }]\nstarts = [1]\n",
                Made())
        .coordinates.back();
  };
  EXPECT_FALSE(shape_with("").other_below || shape_with("").other_above);
  EXPECT_TRUE(shape_with(", stop = \"below\"").other_below);
  EXPECT_FALSE(shape_with(", stop = \"below\"").other_above);
  EXPECT_TRUE(shape_with(", stop = \"both\"").other_below && shape_with(", stop = \"both\"").other_above);
}

TEST(FormFile, AVariantHasWhatItLeavesOutFromTheFormBeforeIt) {
  const Signals s = Made();
  const std::string head =
      "schema = 1\n[[form]]\neffect = \"made\"\nfamily = \"kind\"\ntext = \"made\"\nslot = \"output\"\n";
  const auto forms =
      FormsFromText(head + kAmplitude + "formula = \"force*v\"\ngates_by_mode = true\nown_groups = [\"speed\"]\n" +
                        "[[form]]\nvariant = \"other\"\ntext = \"other\"\nslot = \"output\"\nformula = \"2*force*x\"\n",
                    "made.toml", s, {});
  ASSERT_EQ(forms.size(), 2U);
  EXPECT_EQ(forms[1].effect, "made");
  EXPECT_EQ(forms[1].family, "kind");
  EXPECT_EQ(forms[1].variant, "other");
  EXPECT_EQ(forms[1].formula, "other");
  EXPECT_TRUE(forms[1].gates_by_mode);
  EXPECT_EQ(forms[1].own_groups, std::vector<std::string>{"speed"});
  ASSERT_EQ(forms[1].size(), 1);
  EXPECT_NEAR(forms[1].features(s, nullptr)(100, 0), 12.0 * s.at(Role::kPosition)[100], 1e-12);
  EXPECT_NEAR(forms[0].features(s, nullptr)(100, 0), 6.0 * s.at(Role::kVelocity)[100], 1e-12);
  EXPECT_NE(MessageOf("variant = \"alone\"\nslot = \"output\"\nformula = \"1\"\n").find("after the form"),
            std::string::npos);
}

TEST(FormFile, SaysWhatIsWrongAndWhere) {
  const std::string output = "slot = \"output\"\n";
  EXPECT_NE(MessageOf(output + kAmplitude + "formula = \"force*speeed\"\n").find("unknown"), std::string::npos);
  EXPECT_NE(MessageOf(output + kAmplitude + "formula = \"force^2\"\n").find("not linear"), std::string::npos);
  EXPECT_NE(MessageOf(output + kAmplitude + "formula = \"force*integral(v)\"\n").find("use a state"),
            std::string::npos);
  EXPECT_NE(MessageOf(output + kAmplitude + "takes = \"no_effect\"\n").find("no effect is called"), std::string::npos);
  EXPECT_NE(MessageOf(output + kAmplitude + "takes = \"drag/of_a_kind\"\n").find("no such form"), std::string::npos);
  EXPECT_NE(MessageOf(output + kAmplitude + "takes = \"drag\"\n").find("c2"), std::string::npos);
  EXPECT_NE(
      MessageOf("slot = \"rate\"\ntakes = \"coulomb_friction\"\nwith = { Fc = \"force\" }\n" + std::string(kAmplitude))
          .find("\"vs\""),
      std::string::npos);
  EXPECT_NE(MessageOf(output + kAmplitude + "formula = \"force*v\"\nspeed = 1\n").find("speed"), std::string::npos);
  EXPECT_NE(
      MessageOf(output + kAmplitude + "states.z = { rate = \"v - z^2\" }\nformula = \"force*z\"\n").find("not linear"),
      std::string::npos);
  EXPECT_NE(
      MessageOf("slot = \"output\"\nformula = \"1\"\namplitudes = [{ name = \"v\", unit = \"N\" }]\n").find("already"),
      std::string::npos);
  EXPECT_NE(
      MessageOf(
          "slot = \"output\"\nformula = \"f\"\namplitudes = [{ name = \"f\", unit = \"N\", size = \"outputt\" }]\n")
          .find("outputt"),
      std::string::npos);
}

TEST(FormFile, EachThatComesWithTheWorkflowIsOfTheKindThatItsLawTakes) {
  const Signals s = Made();
  const std::map<std::string, double> constants = {
      {"q1", 0.1}, {"q2", 3.0}, {"q3", 100.0}, {"p_supply", 8e5}, {"p_atm", 1e5}};
  for (const char* law : {"contact", "bending", "valve_flow"})
    for (const EffectForm& form : FormsFor(law, s, constants)) {
      EXPECT_FALSE(form.family.empty()) << law << ": " << form.effect;
      EXPECT_TRUE(form.features || form.force || form.filter || form.sense) << law << ": " << form.effect;
      EXPECT_TRUE(form.find_starts || !form.starts.empty()) << law << ": " << form.effect << " " << form.variant;
      for (const Coordinate& c : form.coordinates)
        EXPECT_LT(c.lower, c.upper) << law << ": " << form.effect << ": " << c.name;
    }
  EXPECT_THROW((void)FormsFor("no law", s, {}), std::out_of_range);
}

}  // namespace
}  // namespace armcmc::gap::form_file_test
