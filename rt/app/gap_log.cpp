#include "gap_log.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <system_error>
#include <utility>

#include "armcmc/models/registry.hpp"
#include "armcmc/plant/program.hpp"

namespace armcmc::app {
namespace {

namespace fs = std::filesystem;

constexpr char kStem[] = "gap-";
constexpr auto kPause = std::chrono::milliseconds(20);

void AppendNumber(double value, std::string* text) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text->append(digits, end);
}

/// Writes all of `text` to the disk. @return false with errno set.
bool WriteWhole(const std::string& path, const std::string& text) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) return false;
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = ::write(file, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    done += static_cast<std::size_t>(n);
  }
  const bool flushed = done == text.size() && ::fsync(file) == 0;
  const int error = errno;
  const bool closed = ::close(file) == 0;
  if (!flushed) errno = error;
  return flushed && closed;
}

}  // namespace

std::vector<std::string> ColumnsOf(const EstimatorSettings& settings) {
  std::vector<std::string> names;
  if (settings.plant == nullptr) {
    const ModelInfo& model = *CompiledModels()[static_cast<std::size_t>(FindModel(settings.model))];
    for (std::size_t i = 0; i < static_cast<std::size_t>(model.num_inputs); ++i)
      names.emplace_back(model.compiled->inputs[i].name);
    names.emplace_back(model.compiled->output.name);
    return names;
  }
  const PlantDescription& plant = settings.plant->plant().description();
  for (const SignalDescription& signal : plant.signals)
    if (signal.name != plant.output) names.push_back(signal.name);
  names.push_back(plant.output);
  return names;
}

GapLog::GapLog(const GapLogSettings& settings, std::vector<std::string> columns, rt::RecordRing* packs,
               const std::atomic<std::int64_t>* alarm, Say say)
    : settings_(settings),
      columns_(std::move(columns)),
      packs_(packs),
      alarm_(alarm),
      say_(std::move(say)),
      num_columns_(columns_.size() + 1),
      rows_(kMaxRows * num_columns_) {}

void GapLog::Start() {
  thread_ = std::thread([this] {
    while (!stop_.load(std::memory_order_acquire)) {
      Poll();
      std::this_thread::sleep_for(kPause);
    }
  });
}

void GapLog::Stop() {
  stop_.store(true, std::memory_order_release);
  if (thread_.joinable()) thread_.join();
  Poll();
  if (raised_ && !complete_) {
    complete_ = true;
    Write();
  }
}

void GapLog::Take(const DataPack& pack) {
  // Of packs that overlap all but the newest samples have come before, unless packs were lost.
  const int fresh = std::max(1, pack.num_samples / settings_.overlap);
  const auto time_of = [&pack](int n) { return pack.t_last_s - (pack.num_samples - 1 - n) * pack.dt; };
  int first = pack.num_samples - fresh;
  // A file holds one run of the plant, in order.
  if (count_ == 0 || pack.run_id != run_id_ || time_of(first) <= Row(count_ - 1)[0]) {
    if (count_ > 0 && raised_) return;  // what belongs to the alarm is not mixed with what came after
    count_ = 0;
    first = 0;
  }
  while (first > 0 && time_of(first - 1) > Row(count_ - 1)[0] + 0.5 * pack.dt) --first;
  run_id_ = pack.run_id;
  for (int n = first; n < pack.num_samples; ++n) {
    if (count_ == kMaxRows) {
      first_ = (first_ + 1) % kMaxRows;
      --count_;
    }
    double* row = Row(count_++);
    // Nanoseconds: the product of a number of samples and an interval has digits that nobody measured.
    row[0] = std::round(time_of(n) * 1e9) / 1e9;
    const auto& inputs = pack.u[static_cast<std::size_t>(n)];
    std::copy_n(inputs.begin(), num_columns_ - 2, row + 1);
    row[num_columns_ - 1] = pack.y[static_cast<std::size_t>(n)];
  }
}

void GapLog::Trim() {
  const double end = raised_ ? alarm_t_ : (count_ > 0 ? Row(count_ - 1)[0] : 0.0);
  while (count_ > 0 && Row(0)[0] < end - settings_.window_s) {
    first_ = (first_ + 1) % kMaxRows;
    --count_;
  }
}

void GapLog::Poll() {
  while (const DataPack* pack = packs_->Front()) {
    if (!complete_) Take(*pack);
    packs_->Pop();
    if (!complete_) Trim();
  }
  if (settings_.directory.empty() || complete_ || count_ == 0) return;
  if (!raised_ && alarm_->load(std::memory_order_acquire) > 0) {
    raised_ = true;
    alarm_t_ = Row(count_ - 1)[0];
    path_ = NewPath();
    Write();
  }
  if (raised_ && Row(count_ - 1)[0] >= alarm_t_ + settings_.after_s) {
    complete_ = true;
    Write();
  }
}

std::string GapLog::NewPath() const {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char time[32];
  std::strftime(time, sizeof time, "%Y%m%dT%H%M%SZ", &utc);
  const auto name = std::string(kStem) + time + "-" + std::to_string(::getpid()) + ".csv";
  return fs::absolute(fs::path(settings_.directory) / name).string();
}

void GapLog::RemoveOldest() const {
  std::error_code error;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(settings_.directory, error)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(kStem, 0) == 0 && entry.path().extension() == ".csv") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());  // names begin with the time
  const auto keep = static_cast<std::size_t>(settings_.max_files);
  for (std::size_t i = 0; i + keep < files.size(); ++i) fs::remove(files[i], error);
}

void GapLog::Write() {
  std::string text = "# samples around a suspected gap between the model and the plant; the alarm rose at t = ";
  AppendNumber(alarm_t_, &text);
  text += "\n";
  text += "t";
  for (const std::string& name : columns_) text += "," + name;
  text += "\n";
  text.reserve(text.size() + count_ * num_columns_ * 24);
  for (std::size_t i = 0; i < count_; ++i) {
    const double* row = Row(i);
    for (std::size_t c = 0; c < num_columns_; ++c) {
      if (c > 0) text += ',';
      AppendNumber(row[c], &text);
    }
    text += '\n';
  }
  std::error_code error;
  fs::create_directories(settings_.directory, error);
  const std::string temporary = path_ + ".tmp";
  if (!WriteWhole(temporary, text) || std::rename(temporary.c_str(), path_.c_str()) != 0) {
    const std::string reason = std::strerror(errno);
    std::remove(temporary.c_str());
    say_("the data around the suspected gap could not be written to " + path_ + ": " + reason +
         (rows_written_ > 0 ? "; the shorter window from the alarm is still there" : ""));
    if (rows_written_ == 0) path_.clear();
    complete_ = true;
    return;
  }
  rows_written_ = count_;
  say_(std::to_string(count_) + " samples around the suspected gap are in " + path_);
  RemoveOldest();
}

}  // namespace armcmc::app
