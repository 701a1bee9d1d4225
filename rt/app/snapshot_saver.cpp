#include "snapshot_saver.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "armcmc/rt/clock.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::app {
namespace {

constexpr auto kWritePause = std::chrono::milliseconds(50);
constexpr auto kInterval = std::chrono::seconds(1);

/// Moves a snapshot that will not be used out of the way of the new one. @return what to say of it.
std::string SetAside(const std::string& path) {
  std::error_code error;
  std::string aside = path + ".refused";
  for (int n = 2; std::filesystem::exists(aside, error); ++n) aside = path + ".refused" + std::to_string(n);
  std::filesystem::rename(path, aside, error);
  return error ? "it could not be set aside: " + error.message() : "it is kept as " + aside;
}

}  // namespace

SnapshotSaver::SnapshotSaver(std::string path, Snapshot start, rt::SnapshotHandOver* parts, Say say,
                             OnFailure on_failure)
    : path_(std::move(path)),
      snapshot_(std::move(start)),
      adjusted_(rt::SplitParts(snapshot_.adjusted, parts->size())),
      executed_(rt::SplitParts(snapshot_.executed, parts->size())),
      resumed_from_(snapshot_.seq),
      parts_(parts),
      say_(std::move(say)),
      on_failure_(std::move(on_failure)) {
  adjusted_.resize(static_cast<std::size_t>(parts->size()));  // empty where there is nothing to go on from
  executed_.resize(static_cast<std::size_t>(parts->size()));
}

void SnapshotSaver::Take() {
  std::int64_t newest = 0;  // a plant that restarts begins to count anew
  for (int j = 0; j < parts_->size(); ++j) {
    rt::SnapshotHandOver::Recursion& from = parts_->of(j);
    if (const rt::SnapshotPart* part = from.adjusted.Take(); part != nullptr) {
      adjusted_[static_cast<std::size_t>(j)].assign(part->used().begin(), part->used().end());
      newest = std::max(newest, part->seq);
      fresh_ = true;
    }
    if (const rt::SnapshotPart* part = from.executed.Take(); part != nullptr) {
      executed_[static_cast<std::size_t>(j)].assign(part->used().begin(), part->used().end());
      fresh_ = true;
    }
  }
  if (newest > 0) snapshot_.seq = newest;
}

bool SnapshotSaver::Complete() const {
  for (std::size_t j = 0; j < adjusted_.size(); ++j)
    if (!adjusted_[j].empty() && !executed_[j].empty()) return true;
  return false;
}

void SnapshotSaver::Save() {
  Take();
  if (!fresh_ || !Complete()) return;
  snapshot_.adjusted = rt::JoinParts(adjusted_);
  snapshot_.executed = rt::JoinParts(executed_);
  snapshot_.utime = rt::RealtimeMicros();
  const std::string reason = ReplaceFile(path_, EncodeSnapshot(snapshot_));
  if (reason.empty()) {
    fresh_ = false;
    written_.fetch_add(1, std::memory_order_relaxed);
    if (reported_) say_("the snapshot " + path_ + " can be written again");
    reported_ = false;
    return;
  }
  failed_.fetch_add(1, std::memory_order_relaxed);
  on_failure_();
  if (!reported_)
    say_("the snapshot " + path_ + " cannot be written: " + reason + "; continuing without it, and trying again");
  reported_ = true;
}

void SnapshotSaver::Start() {
  thread_ = std::thread([this] {
    auto due = std::chrono::steady_clock::now() + kInterval;
    while (!stop_.load(std::memory_order_acquire)) {
      std::this_thread::sleep_for(kWritePause);
      if (std::chrono::steady_clock::now() < due) continue;
      Save();
      due = std::chrono::steady_clock::now() + kInterval;
    }
  });
}

void SnapshotSaver::Stop() {
  if (!thread_.joinable()) return;
  stop_.store(true, std::memory_order_release);
  thread_.join();
  Save();
}

Snapshot LoadSnapshot(const std::string& path, std::uint64_t identity, std::int64_t now_utime,
                      const std::function<bool(const Snapshot&)>& use, const SnapshotSaver::Say& say) {
  Snapshot snapshot;
  Snapshot nothing;
  nothing.identity = identity;
  if (!std::filesystem::exists(path)) {
    say("no snapshot " + path + " yet: starting afresh");
    return nothing;
  }
  const auto leave_alone = [&path](const std::string& why) {
    return support::InputError("--resume " + path + ": " + why + "; it is left as it is: name another file");
  };
  if (!std::filesystem::is_regular_file(path)) throw leave_alone("not a regular file");
  // The snapshots of this program may be read by everyone.
  if (::access(path.c_str(), R_OK) != 0 && errno == EACCES) throw leave_alone(std::strerror(EACCES));
  std::vector<std::byte> bytes;
  std::string reason = ReadFile(path, &bytes);
  if (!MayBeSnapshot(bytes)) throw leave_alone("not a snapshot of an estimator");
  if (!reason.empty()) {
    reason = "cannot be read: " + reason;
  } else {
    reason = DecodeSnapshot(bytes, identity, &snapshot);
    if (reason.empty() && !use(snapshot)) reason = "is damaged: its content is invalid";
  }
  if (!reason.empty()) {
    // It may be of use to another program: that of a newer version, or of the model that it belongs to.
    say("the snapshot " + path + " is refused, it " + reason + "; starting afresh, " + SetAside(path));
    return nothing;
  }
  say("continuing from pack " + std::to_string(snapshot.seq) + " in the snapshot " + path + ", saved " +
      std::to_string((now_utime - snapshot.utime) / 1'000'000) + " s ago");
  return snapshot;
}

}  // namespace armcmc::app
