// Words of a file that programs repeat: bytes that a terminal would act on never reach it.

#include "armcmc/support/printable.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::support::printable_test {
namespace {

using test::Outcome;
using test::Program;
using test::RunProgram;
using test::ScratchDir;
using testing::HasSubstr;

TEST(Printable, EscapesWhatATerminalActsOn) {
  EXPECT_EQ(Escaped("\x1b[2Jx\a\x7f\t"), "\\x1b[2Jx\\x07\\x7f\\x09");
  EXPECT_EQ(Escaped("\xC2\x9B"), "\\xc2\\x9b") << "CSI of the C1 set, as UTF-8";
  EXPECT_EQ(Escaped(std::string("a\0b", 3)), "a\\x00b");
}

TEST(Printable, LeavesUtf8AndEscapesWhatIsNone) {
  EXPECT_EQ(Escaped("Größe µ → 𝜃"), "Größe µ → 𝜃");
  EXPECT_EQ(Escaped("\xFF\xFE"), "\\xff\\xfe");
  EXPECT_EQ(Escaped("\xC3"), "\\xc3") << "cut off";
  EXPECT_EQ(Escaped("\xC0\xAF"), "\\xc0\\xaf") << "overlong";
  EXPECT_EQ(Escaped("\xED\xA0\x80"), "\\xed\\xa0\\x80") << "a surrogate";
  EXPECT_EQ(Escaped("\xF4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond Unicode";
}

TEST(Printable, CutsBetweenCharacters) {
  EXPECT_EQ(Printable("abcdef", 6), "abcdef");
  EXPECT_EQ(Printable("äöüß", 2), "äö...");
  EXPECT_EQ(Printable(std::string(10'000, 'x')), std::string(60, 'x') + "...");
}

/// One line of what may be shown, of at most some hundred bytes for each word that it repeats.
void ExpectHarmless(const Outcome& run) {
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err.size();
  EXPECT_LT(run.err.size(), 2000U);
  EXPECT_EQ(Escaped(run.err.substr(0, run.err.size() - 1)) + '\n', run.err);
}

TEST(Printable, HeadersOfABrokenCsvAreShownAndCut) {
  const ScratchDir dir;
  const std::string csv = dir / "broken.csv";
  const auto replay = [&](const std::string& text) {
    std::ofstream(csv, std::ios::binary) << text;
    return RunProgram(Program("armcmc-replay"), {"--config", "hunt_crossley", "--data", csv, "--out", dir / "out.csv"});
  };
  const Outcome escape = replay("t,\x1b]0;owned\a,\xff\xfe\n0,1,2\n");
  ExpectHarmless(escape);
  EXPECT_THAT(escape.err, HasSubstr("\\x1b]0;owned\\x07,\\xff\\xfe"));
  ExpectHarmless(replay("t," + std::string(10'000, 'x') + "\n0,1\n"));
  std::string many = "t";
  for (int i = 0; i < 3000; ++i) many += ",c" + std::to_string(i);
  const Outcome long_header = replay(many + "\n");
  ExpectHarmless(long_header);
  EXPECT_THAT(long_header.err, HasSubstr("(3001 in all)"));
  ExpectHarmless(replay("t,x,v,f\n0,1,2,\x1b[31m\n"));
}

TEST(Printable, KeysAndTextsOfABrokenTomlAreShownAndCut) {
  const ScratchDir dir;
  const std::string plant = dir / "broken.toml";
  const std::string tail =
      "[signals]\nu = { unit = \"1\" }\ny = { unit = \"1\" }\n[parameters]\nk = { unit = \"1\", mean = 0, sd = 1 }\n"
      "[noise]\nstd = 1.0\n";
  // What is broken of a file, and what the error shows of it.
  const auto expect = [&](const std::string& name, const std::string& law, const std::string& more,
                          const std::string& shown) {
    std::ofstream(plant, std::ios::binary)
        << "schema = 1\nname = \"" << name << "\"\noutput = \"y\"\nlaw = \"" << law << "\"\n"
        << more << tail;
    const Outcome run = RunProgram(Program("armcmc-model"), {"check", plant});
    SCOPED_TRACE(shown);
    ExpectHarmless(run);
    EXPECT_THAT(run.err, HasSubstr(shown));
  };
  expect("p", "k*u", "\"\\u001b[2J\" = 1\n", "\"\\x1b[2J\": unknown key");
  expect("p", "k*u", "\"\\u009b\" = 1\n", "\"\\xc2\\x9b\": unknown key");
  expect("p", "k*u", std::string(10'000, 'k') + " = 1\n", ":5:10004: " + std::string(60, 'k') + "...: unknown key");
  expect("\\u001b[2J", "k*u", "", "name = \"\\x1b[2J\"");
  expect("p", "\\u001b[2J" + std::string(3000, '('), "", "law = \"\\x1b[2J(((");
  expect("p", "k*q", "[\"" + std::string(200, 'x') + "\\u0007\"]\nq = 1\n", "broken.toml:");
  expect("p", "k*u", "\x1b[2J\n", "broken.toml:5:1: ");
  expect("p", "k*u", "\xff = 1\n", "invalid utf-8 sequence");
}

}  // namespace
}  // namespace armcmc::support::printable_test
