#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/rt/snapshot_hand_over.hpp"
#include "armcmc/rt/step_engine.hpp"
#include "armcmc/rt/warm_up.hpp"
#include "armcmc/snapshot.hpp"
#include "armcmc/support/program.hpp"
#include "full_disk.hpp"
#include "snapshot_saver.hpp"
#include "support/paths.hpp"

namespace armcmc::app::snapshot_test {
namespace {

constexpr std::uint64_t kIdentity = 42;

std::vector<std::byte> Bytes(std::size_t size, int value) {
  return std::vector<std::byte>(size, static_cast<std::byte>(value));
}

Snapshot Example() {
  Snapshot s;
  s.identity = kIdentity;
  s.seq = 17;
  s.utime = 1'000'000;
  s.adjusted = Bytes(1000, 1);
  s.executed = Bytes(500, 2);
  return s;
}

std::string Refusal(std::vector<std::byte> bytes, std::uint64_t identity = kIdentity) {
  Snapshot s;
  return DecodeSnapshot(bytes, identity, &s);
}

TEST(SnapshotFile, ReadsWhatWasWritten) {
  Snapshot s;
  ASSERT_EQ(DecodeSnapshot(EncodeSnapshot(Example()), kIdentity, &s), "");
  EXPECT_EQ(s.seq, 17);
  EXPECT_EQ(s.utime, 1'000'000);
  EXPECT_EQ(s.adjusted, Example().adjusted);
  EXPECT_EQ(s.executed, Example().executed);
}

TEST(SnapshotFile, RefusesWhatItDoesNotKnowAndSaysWhy) {
  const auto good = EncodeSnapshot(Example());
  EXPECT_EQ(Refusal({}), "is empty");
  EXPECT_EQ(Refusal(Bytes(2000, 7)), "is not a snapshot of an estimator");
  auto damaged = good;
  std::fill_n(damaged.begin(), 4, std::byte{0xa5});
  EXPECT_EQ(Refusal(damaged), "is damaged: its first bytes are wrong");
  auto foreign = good;
  foreign[8] = std::byte{99};
  EXPECT_EQ(Refusal(foreign), "has version 99 of a newer program, expected 5");
  EXPECT_EQ(Refusal(good, kIdentity + 1), "belongs to another model, or to other priors, bounds or noise");
}

TEST(SnapshotFile, RefusesEveryTruncationAndEveryChangedBit) {
  const auto good = EncodeSnapshot(Example());
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_NE(Refusal({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}), "") << size;
  auto longer = good;
  longer.push_back(std::byte{0});
  EXPECT_NE(Refusal(longer), "");
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto damaged = good;
    damaged[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    ASSERT_NE(Refusal(damaged), "") << bit;
  }
}

TEST(SnapshotChannel, HandsOverWholePartsFromOneThreadToAnother) {
  constexpr std::int64_t kParts = 20'000;
  rt::SnapshotChannel channel(512);
  std::thread stage([&channel] {
    for (std::int64_t seq = 1; seq <= kParts; ++seq)
      channel.Write(seq, [seq](std::span<std::byte> out) noexcept {
        std::fill(out.begin(), out.end(), static_cast<std::byte>(seq & 0xff));
        return out.size();
      });
  });
  std::int64_t last = 0;
  int torn = 0, old = 0;
  while (last < kParts) {  // the newest is never lost
    const rt::SnapshotPart* part = channel.Take();
    if (part == nullptr) {
      std::this_thread::yield();
      continue;
    }
    old += part->seq <= last ? 1 : 0;
    last = part->seq;
    for (const std::byte b : part->used()) torn += b != static_cast<std::byte>(last & 0xff) ? 1 : 0;
  }
  stage.join();
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(old, 0);
}

class SnapshotSaverTest : public ::testing::Test {
 protected:
  void Learn(std::int64_t seq, int value) {
    const auto save = [value](std::span<std::byte> out) noexcept {
      std::fill(out.begin(), out.end(), static_cast<std::byte>(value));
      return out.size();
    };
    parts_.of(0).adjusted.Write(seq, save);
    parts_.of(0).executed.Write(seq, save);
  }
  std::unique_ptr<SnapshotSaver> Make(Snapshot start = {}) {
    start.identity = kIdentity;
    return std::make_unique<SnapshotSaver>(
        Path(), std::move(start), &parts_, [this](const std::string& line) { said_.push_back(line); },
        [this] { ++faults_; });
  }
  [[nodiscard]] std::string Path() const { return dir_ / "learnt.snapshot"; }
  Snapshot Load(bool usable = true) {
    return LoadSnapshot(
        Path(), kIdentity, 10'000'000, [usable](const Snapshot&) { return usable; },
        [this](const std::string& line) { said_.push_back(line); });
  }

  armcmc::test::ScratchDir dir_;
  rt::SnapshotHandOver parts_{64};
  std::vector<std::string> said_;
  int faults_ = 0;
};

TEST_F(SnapshotSaverTest, WritesTheNewestAndNothingTwice) {
  auto saver = Make();
  saver->Save();
  EXPECT_FALSE(std::filesystem::exists(Path())) << "nothing was learnt";
  Learn(1, 1);
  Learn(2, 2);
  saver->Save();
  saver->Save();
  EXPECT_EQ(saver->written(), 1);
  const Snapshot s = Load();
  EXPECT_EQ(s.seq, 2);
  EXPECT_EQ(s.adjusted, Bytes(64, 2));
  EXPECT_FALSE(std::filesystem::exists(Path() + ".tmp"));
}

TEST_F(SnapshotSaverTest, KeepsAPartOfWhichNothingNewCame) {
  auto saver = Make(Example());
  parts_.of(0).executed.Write(18, [](std::span<std::byte> out) noexcept { return out.size(); });
  saver->Save();
  const Snapshot s = Load();
  EXPECT_EQ(s.adjusted, Example().adjusted);
  EXPECT_EQ(s.executed.size(), 64U);
}

TEST_F(SnapshotSaverTest, WritesWhatIsDueAtItsEnd) {
  auto saver = Make();
  saver->Start();
  Learn(5, 5);
  saver->Stop();
  EXPECT_EQ(Load().seq, 5);
}

TEST_F(SnapshotSaverTest, AFullDiskIsCountedToldOnceAndTheOldFileStays) {
  auto saver = Make();
  Learn(1, 1);
  saver->Save();
  Learn(2, 2);
  {
    const test::FullDisk full(40);
    saver->Save();
    saver->Save();
  }
  EXPECT_EQ(saver->failed(), 2);
  EXPECT_EQ(faults_, 2);
  ASSERT_EQ(said_.size(), 1U);
  EXPECT_NE(said_[0].find("cannot be written: File too large"), std::string::npos) << said_[0];
  EXPECT_EQ(Load().seq, 1) << "whole, and the old one";
  EXPECT_FALSE(std::filesystem::exists(Path() + ".tmp"));

  saver->Save();
  EXPECT_EQ(Load().seq, 2) << "what could not be written is not forgotten";
}

TEST_F(SnapshotSaverTest, AFolderThatIsGoneIsNoEnd) {
  auto saver = Make();
  std::filesystem::remove_all(dir_.path());
  Learn(1, 1);
  saver->Save();
  EXPECT_EQ(saver->failed(), 1);
  std::filesystem::create_directories(dir_.path());
  saver->Save();
  EXPECT_EQ(saver->written(), 1);
}

TEST_F(SnapshotSaverTest, SaysInOneLineWhatBecomesOfTheFile) {
  EXPECT_EQ(Load().seq, 0);
  ASSERT_EQ(ReplaceFile(Path(), EncodeSnapshot(Example())), "");
  EXPECT_EQ(Load().seq, 17);
  EXPECT_EQ(Load(false).seq, 0);
  ASSERT_EQ(ReplaceFile(Path(), Bytes(100, 0)), "");
  EXPECT_EQ(Load().seq, 0);
  const std::string file = Path();
  ASSERT_EQ(said_.size(), 4U);
  EXPECT_EQ(said_[0], "no snapshot " + file + " yet: starting afresh");
  EXPECT_EQ(said_[1], "continuing from pack 17 in the snapshot " + file + ", saved 9 s ago");
  EXPECT_EQ(said_[2], "the snapshot " + file +
                          " is refused, it is damaged: its content is invalid; starting afresh, it is kept as " + file +
                          ".refused");
  EXPECT_EQ(said_[3], "the snapshot " + file +
                          " is refused, it is damaged: its first bytes are wrong; starting afresh, it is kept as " +
                          file + ".refused2");
}

TEST_F(SnapshotSaverTest, WhatIsNoSnapshotStaysWhereItIs) {
  const std::string table = "t,x,y\n0,1,2\n";
  const auto words = std::as_bytes(std::span(table));
  ASSERT_EQ(ReplaceFile(Path(), words), "");
  EXPECT_THROW((void)Load(), support::InputError);
  std::vector<std::byte> kept;
  EXPECT_EQ(ReadFile(Path(), &kept), "");
  EXPECT_TRUE(std::equal(kept.begin(), kept.end(), words.begin(), words.end()));
  std::filesystem::remove(Path());
  std::filesystem::create_directory(Path());
  EXPECT_THROW((void)Load(), support::InputError);
  EXPECT_TRUE(std::filesystem::is_directory(Path()));
  EXPECT_FALSE(std::filesystem::exists(Path() + ".refused"));
  EXPECT_TRUE(said_.empty());
}

TEST_F(SnapshotSaverTest, ADamagedSnapshotIsNotTakenForAnotherFile) {
  const std::vector<std::byte> good = EncodeSnapshot(Example());
  for (std::size_t size = 0; size < 20; ++size) EXPECT_TRUE(MayBeSnapshot(std::span(good).first(size))) << size;
  std::vector<std::byte> damaged = good;
  for (std::size_t i = 0; i < 4; ++i) damaged[2 * i] = std::byte{0xa5};
  EXPECT_TRUE(MayBeSnapshot(std::span(damaged).first(8)));
  std::fill_n(damaged.begin(), 48, std::byte{0});
  EXPECT_TRUE(MayBeSnapshot(damaged)) << "a block that is lost";
  damaged = good;
  std::fill_n(damaged.begin(), 8, std::byte{0xa5});
  EXPECT_TRUE(MayBeSnapshot(damaged)) << "nothing but the first bytes";
  for (const char* other : {"t,x,y\n", "armcmcsn", "ARM", "a", "schema = 1\n", "\xed\xa1\xda\x01"}) {
    const std::string text = other;
    EXPECT_EQ(MayBeSnapshot(std::as_bytes(std::span(text))), text == "ARM") << text;
  }
}

TEST_F(SnapshotSaverTest, ARefusedFileIsSetAsideAndNeverReplaced) {
  const std::vector<std::byte> content = EncodeSnapshot(Example());
  ASSERT_EQ(ReplaceFile(Path(), content), "");
  EXPECT_EQ(Load(false).seq, 0);
  auto saver = Make();
  Learn(1, 1);
  saver->Save();
  EXPECT_EQ(saver->written(), 1);
  ASSERT_EQ(ReplaceFile(Path(), Bytes(100, 0)), "");
  EXPECT_EQ(Load().seq, 0);
  std::vector<std::byte> kept;
  EXPECT_EQ(ReadFile(Path() + ".refused", &kept), "");
  EXPECT_EQ(kept, content);
  EXPECT_EQ(ReadFile(Path() + ".refused2", &kept), "");
  EXPECT_EQ(kept, Bytes(100, 0));
}

/// The engine of the pipeline: what its warm-up learns reaches nobody, and ends where it was resumed.
TEST(EngineSnapshots, SurviveTheWarmUpAndHoldNothingOfIt) {
  const EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  auto parts = std::make_unique<rt::SnapshotHandOver>(Estimator::kSnapshotBytes);
  rt::EstimatorEngine engine(settings);
  engine.SetSnapshots(parts.get());
  rt::WarmUp(&engine);
  EXPECT_EQ(parts->of(0).adjusted.Take(), nullptr);
  EXPECT_EQ(parts->of(0).executed.Take(), nullptr);

  const auto estimate = std::make_unique<Estimate>();
  for (int i = 0; i < 4; ++i) {
    ASSERT_EQ(engine.Adjust(rt::SyntheticPack(engine.pack_format(), 10 + i), 0, ClockRef{}, 0), Status::kOk);
    engine.Execute(0, estimate.get());
    engine.Remember(ClockRef{});
  }
  const rt::SnapshotPart* adjusted = parts->of(0).adjusted.Take();
  const rt::SnapshotPart* executed = parts->of(0).executed.Take();
  ASSERT_TRUE(adjusted != nullptr && executed != nullptr);
  EXPECT_EQ(adjusted->seq, 14);

  rt::EstimatorEngine second(settings);
  ASSERT_TRUE(second.Resume(adjusted->used(), executed->used()));
  rt::WarmUp(&second);
  const auto resumed = std::make_unique<Estimate>();
  ASSERT_EQ(second.Adjust(rt::SyntheticPack(second.pack_format(), 14), 0, ClockRef{}, 0), Status::kOk);
  second.Execute(0, resumed.get());
  ASSERT_EQ(engine.Adjust(rt::SyntheticPack(engine.pack_format(), 14), 0, ClockRef{}, 0), Status::kOk);
  engine.Execute(0, estimate.get());
  EXPECT_EQ(resumed->modes[0].decision, Decision::kReinforcement);
  EXPECT_EQ(resumed->modes[0].log_evidence, estimate->modes[0].log_evidence);
  EXPECT_EQ(resumed->modes[0].marginal[0].ar_ap, estimate->modes[0].marginal[0].ar_ap);
}

TEST(SnapshotParts, AreThoseThatWereJoined) {
  const std::vector<std::vector<std::byte>> parts = {Bytes(100, 1), {}, Bytes(7, 3)};
  EXPECT_EQ(rt::SplitParts(rt::JoinParts(parts), 3), parts);
  const std::vector<std::vector<std::byte>> single(1, Bytes(9, 4));
  EXPECT_EQ(rt::JoinParts(single), single.front()) << "as it is";
  EXPECT_EQ(rt::SplitParts(single.front(), 1), single);
  // Another number of parts, or bytes missing or left over.
  std::vector<std::byte> joined = rt::JoinParts(parts);
  EXPECT_TRUE(rt::SplitParts(joined, 2).empty());
  EXPECT_TRUE(rt::SplitParts(joined, 4).empty());
  joined.pop_back();
  EXPECT_TRUE(rt::SplitParts(joined, 3).empty());
}

/// Where packs overlap: every recursion goes on from its own part; those that have none yet begin afresh.
TEST(EngineSnapshots, HoldEveryRecursion) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.overlap = 4;
  armcmc::test::ScratchDir dir;
  const std::string path = dir / "learnt.snapshot";
  rt::SnapshotHandOver parts(Estimator::kSnapshotBytes, settings.overlap);
  rt::EstimatorEngine engine(settings);
  engine.SetSnapshots(&parts);
  rt::WarmUp(&engine);
  SnapshotSaver saver(
      path, {.identity = kIdentity, .seq = 0, .utime = 0, .adjusted = {}, .executed = {}}, &parts,
      [](const std::string&) {}, [] {});
  const auto estimate = std::make_unique<Estimate>(), resumed = std::make_unique<Estimate>();
  const auto step = [](rt::EstimatorEngine* of, int seq, Estimate* to) {
    ASSERT_EQ(of->Adjust(rt::SyntheticPack(of->pack_format(), seq), 0, ClockRef{}, 0), Status::kOk) << seq;
    of->Execute(0, to);
    of->Remember(ClockRef{});
  };
  int next = 10;
  for (const int packs : {3, 6}) {  // before every recursion has had a pack, and after that
    for (int i = 0; i < packs; ++i) step(&engine, next++, estimate.get());
    saver.Save();
    Snapshot saved;
    std::vector<std::byte> bytes;
    ASSERT_EQ(ReadFile(path, &bytes), "");
    ASSERT_EQ(DecodeSnapshot(bytes, kIdentity, &saved), "");
    EXPECT_EQ(saved.seq, next);

    rt::EstimatorEngine second(settings);
    ASSERT_TRUE(second.Resume(saved.adjusted, saved.executed));
    rt::WarmUp(&second);
    for (int i = 0; i < settings.overlap; ++i, ++next) {
      step(&engine, next, estimate.get());
      step(&second, next, resumed.get());
      EXPECT_EQ(resumed->modes[0].decision, estimate->modes[0].decision) << next;
      EXPECT_EQ(resumed->modes[0].log_evidence, estimate->modes[0].log_evidence) << next;
      EXPECT_EQ(resumed->modes[0].marginal[0].ar_ap, estimate->modes[0].marginal[0].ar_ap) << next;
    }
    saved.adjusted.pop_back();
    EXPECT_FALSE(second.Resume(saved.adjusted, saved.executed)) << "damaged";
  }
}

}  // namespace
}  // namespace armcmc::app::snapshot_test
