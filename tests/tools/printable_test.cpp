// Words of a file that programs repeat: bytes that a terminal would act on never reach it.

#include "armcmc/support/printable.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
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

TEST(Printable, EscapesMarksThatReorderOrBreakALine) {
  EXPECT_EQ(Escaped("a\xE2\x80\xAE"
                    "b"),
            "a\\xe2\\x80\\xaeb")
      << "right-to-left override";
  EXPECT_EQ(Escaped("\xE2\x81\xA6"), "\\xe2\\x81\\xa6") << "isolate";
  EXPECT_EQ(Escaped("\xE2\x80\xA8"), "\\xe2\\x80\\xa8") << "line separator";
  EXPECT_EQ(Escaped("\xE2\x80\xA7\xE2\x80\xAF\xE2\x81\xAA\xE2\x80\x93"),
            "\xE2\x80\xA7\xE2\x80\xAF\xE2\x81\xAA\xE2\x80\x93");
}

TEST(Printable, CutsBetweenCharacters) {
  EXPECT_EQ(Printable("abcdef", 6), "abcdef");
  EXPECT_EQ(Printable("äöüß", 2), "äö...");
  EXPECT_EQ(Printable(std::string(10'000, 'x')), std::string(60, 'x') + "...");
}

TEST(Printable, ErrorsAreOneLineWithLongWordsCutInTheMiddle) {
  EXPECT_EQ(ErrorLine("a\nb\x1b \n"), "a b\\x1b");
  const std::string path = std::string(280, 'p') + "/data.csv";
  EXPECT_EQ(ErrorLine(path + ": missing"), path + ": missing") << "a path of common length";
  EXPECT_EQ(ErrorLine("no " + std::string(10'000, 'x') + "y: missing"),
            "no " + std::string(100, 'x') + "..." + std::string(58, 'x') + "y: missing");
  std::string umlauts;
  for (int i = 0; i < 400; ++i) umlauts += "ä";
  std::string head, tail;
  for (int i = 0; i < 100; ++i) head += "ä";
  for (int i = 0; i < 60; ++i) tail += "ä";
  EXPECT_EQ(ErrorLine(umlauts), head + "..." + tail) << "cut between characters";
  std::string words;
  for (int i = 0; i < 5000; ++i) words += "x ";
  EXPECT_EQ(ErrorLine(words).size(), 2003U);
}

TEST(Printable, WhatAProgramPrintsIsEscapedButForLineBreaksAndTabs) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  {
    const EscapedOutput escaped;
    std::cout << "a\x1b[2J\tµ\n" << '\x1b' << std::setw(4) << "\xff" << std::flush;
    std::cerr << std::string("n\0", 2) << "\xC2\x9B" << '\n';
  }
  std::cout << "\x1b after";
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "a\\x1b[2J\tµ\n\\x1b   \\xff\x1b after");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "n\\x00\\xc2\\x9b\n");
}

/// Text that a terminal only shows, in lines of bounded length.
void ExpectShowable(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LT(line.size(), 2500U) << line.substr(0, 200);
    EXPECT_EQ(Escaped(line), line);
  }
}

/// One line of what may be shown, of at most some hundred bytes for each word that it repeats.
void ExpectEscaped(const Outcome& run) {
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
  ExpectEscaped(escape);
  EXPECT_THAT(escape.err, HasSubstr("\\x1b]0;owned\\x07,\\xff\\xfe"));
  ExpectEscaped(replay("t," + std::string(10'000, 'x') + "\n0,1\n"));
  std::string many = "t";
  for (int i = 0; i < 3000; ++i) many += ",c" + std::to_string(i);
  const Outcome long_header = replay(many + "\n");
  ExpectEscaped(long_header);
  EXPECT_THAT(long_header.err, HasSubstr("(3001 in all)"));
  ExpectEscaped(replay("t,x,v,f\n0,1,2,\x1b[31m\n"));
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
    ExpectEscaped(run);
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

// One word of each kind of file, and of the command line, is what no program expects: whatever the program does with
// it, the terminal only shows it.
TEST(Printable, NoKindOfFileAndNoArgumentReachesTheTerminalRaw) {
  const ScratchDir dir;
  const std::string plant =
      "schema = 1\nname = \"motor\"\noutput = \"w\"\nlaw = \"k*u\"\n[signals]\nu = { unit = \"V\" }\nw = { unit = "
      "\"rad/s\" }\n[parameters]\nk = { unit = \"rad/(s V)\", mean = 1, sd = 1 }\n[noise]\nstd = 0.1\n";
  std::ofstream(dir / "motor.toml") << plant;
  std::ofstream csv(dir / "motor.csv");
  csv << "t,u,w\n";
  for (int i = 0; i < 300; ++i) csv << 0.001 * i << ',' << i % 7 << ',' << i % 7 << '\n';
  csv.close();
  const auto changed = [](std::string text, const std::string& word, const std::string& with) {
    return text.replace(text.find(word), word.size(), with);
  };
  struct Raw {
    std::string in_toml;  // as a TOML string spells it
    std::string bytes;
  };
  const std::vector<Raw> raws{{"\\u001b]0;owned\\u0007", "\x1b]0;owned\a"},
                              {"\\u009b2J", "\xC2\x9B\x32J"},
                              {"a\\u0000b", "a\x01\x7f"},
                              {"\xff\xfe", "\xff\xfe\xC3"},
                              {std::string(10'000, 'x'), std::string(10'000, 'x')}};
  int runs = 0;
  const auto run = [&](const char* program, std::vector<std::string> arguments) {
    for (std::string& argument : arguments)
      if (argument.rfind("@", 0) == 0) argument = dir / argument.substr(1);
    const Outcome outcome = RunProgram(Program(program), arguments);
    SCOPED_TRACE(std::string(program) + " " + Printable(arguments.front()) + " " + std::to_string(runs++));
    EXPECT_THAT(outcome.code, testing::AnyOf(0, 2, 1));
    ExpectShowable(outcome.out);
    ExpectShowable(outcome.err);
  };
  const auto write = [&](const std::string& text) { std::ofstream(dir / "broken.toml", std::ios::binary) << text; };
  for (const Raw& raw : raws) {
    const std::string quoted = '"' + raw.in_toml + '"';
    for (const char* word : {"\"motor\"", "\"w\"", "\"k*u\"", "\"V\"", "\"rad/(s V)\"", "u =", "k =", "sd", "0.1"}) {
      const std::string found(word);
      write(changed(plant, found, found == "u =" || found == "k =" ? quoted + " =" : quoted));
      run("armcmc-model", {"check", "@broken.toml"});
      run("armcmc-plant", {"--model", "@broken.toml", "--duration", "0.2", "--csv", "@out.csv"});
    }
    const std::string recording =
        "schema = 1\nmodel = \"motor.toml\"\nfile = \"motor.csv\"\n[columns]\nt = { column = \"t\" }\nu = { column "
        "= \"u\" }\nw = { column = \"w\" }\n[derivatives]\nbandwidth_hz = 4\nfiltered_with = [\"u\"]\n";
    for (const char* word : {"\"motor.toml\"", "\"motor.csv\"", "\"t\"", "\"w\"", "[\"u\"]", "4"}) {
      write(changed(recording, word, *word == '[' ? '[' + quoted + ']' : quoted));
      run("armcmc-replay", {"--recording", "@broken.toml", "--out", "@out.csv"});
    }
    const std::string scenario =
        "schema = 1\nrate_hz = 1000\nduration_s = 0.2\n[truth]\nk = 2\n[inputs]\nu = { kind = \"sine\", amplitude = 1, "
        "frequency_hz = 5 }\n[noise]\nlaw = \"gaussian\"\nstd = 0.5\n[[hidden]]\nslot = \"output\"\nvalue = \"u\"\n";
    for (const char* word : {"\"sine\"", "\"gaussian\"", "\"output\"", "\"u\"", "1000"}) {
      write(changed(scenario, word, quoted));
      run("armcmc-plant", {"--model", "@motor.toml", "--scenario", "@broken.toml", "--csv", "@out.csv"});
    }
    write("schema = 1\nmethod = " + quoted + "\n[model]\nname = \"hunt_crossley\"\n");
    run("armcmc-replay", {"--config", "@broken.toml", "--data", "@motor.csv", "--out", "@out.csv"});
    write("schema = 1\n[model]\nname = " + quoted + '\n');
    run("armcmc-replay", {"--config", "@broken.toml", "--data", "@motor.csv", "--out", "@out.csv"});
    std::ofstream(dir / "broken.csv", std::ios::binary) << "t,u,w\n0,1,1\n0.001," << raw.bytes << ",1\n0.002,1,1\n";
    run("armcmc-replay", {"--model", "@motor.toml", "--data", "@broken.csv", "--out", "@out.csv"});
    std::ofstream(dir / "broken.csv", std::ios::binary) << "t,u," << raw.bytes << "\n0,1,1\n0.001,1,1\n";
    run("armcmc-replay", {"--model", "@motor.toml", "--data", "@broken.csv", "--out", "@out.csv"});
    run("armcmc-replay", {"--model", "@motor.toml", "--data", "@motor.csv", "--out", '@' + raw.bytes.substr(0, 200)});
    for (const char* option : {"--model", "--scenario", "--duration", "--inject", "--hide-effect", "--csv"})
      run("armcmc-plant", {option, raw.bytes, "--lcm-url", raw.bytes});
    run("armcmc-model", {raw.bytes});
    run("armcmc-model", {"check", raw.bytes});
    run("armcmc-model", {"check", "@motor.toml", "--with", raw.bytes});
  }
  EXPECT_GT(runs, 150);
}

}  // namespace
}  // namespace armcmc::support::printable_test
