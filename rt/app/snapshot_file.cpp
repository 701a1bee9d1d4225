#include "snapshot_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <type_traits>

namespace armcmc::app {
namespace {

constexpr char kMagic[] = {'A', 'R', 'M', 'C', 'M', 'C', 'S', 'N'};
constexpr std::size_t kLargestFile = 160U << 20U;  // both parts of as many recursions as a pack has samples

struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t adjusted_size;
  std::uint64_t identity;
  std::int64_t seq;
  std::int64_t utime;
  std::uint32_t executed_size;
  std::uint32_t reserved;
};
static_assert(sizeof(Header) == 48 && std::is_trivially_copyable_v<Header>);

constexpr std::array<std::uint64_t, 256> MakeCrcTable() {
  std::array<std::uint64_t, 256> table{};
  for (std::uint64_t i = 0; i < 256; ++i) {
    std::uint64_t crc = i << 56U;
    for (int bit = 0; bit < 8; ++bit) crc = (crc << 1U) ^ ((crc >> 63U) != 0 ? 0x42f0e1eba9ea3693ULL : 0U);
    table[i] = crc;
  }
  return table;
}

std::uint64_t Crc64(std::span<const std::byte> bytes) {
  static constexpr auto kTable = MakeCrcTable();
  std::uint64_t crc = 0;
  for (const std::byte b : bytes) crc = (crc << 8U) ^ kTable[(crc >> 56U) ^ static_cast<std::uint64_t>(b)];
  return crc;
}

/// A file descriptor that is closed with the scope.
class File {
 public:
  File(const char* path, int flags, mode_t mode = 0) : fd_(::open(path, flags | O_CLOEXEC, mode)) {}
  ~File() {
    if (fd_ >= 0) ::close(fd_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  [[nodiscard]] int fd() const { return fd_; }
  /// Some file systems tell only here that the disk is full.
  [[nodiscard]] bool Close() {
    const int fd = fd_;
    fd_ = -1;
    return ::close(fd) == 0;
  }

 private:
  int fd_;
};

bool WriteAll(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

bool WriteNew(const std::string& path, std::span<const std::byte> bytes) {
  File file(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  return file.is_open() && WriteAll(file.fd(), bytes) && ::fsync(file.fd()) == 0 && file.Close();
}

}  // namespace

std::vector<std::byte> EncodeSnapshot(const Snapshot& snapshot) {
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = kSnapshotVersion;
  header.identity = snapshot.identity;
  header.seq = snapshot.seq;
  header.utime = snapshot.utime;
  header.adjusted_size = static_cast<std::uint32_t>(snapshot.adjusted.size());
  header.executed_size = static_cast<std::uint32_t>(snapshot.executed.size());
  const std::size_t body = sizeof header + snapshot.adjusted.size() + snapshot.executed.size();
  std::vector<std::byte> bytes(body + sizeof(std::uint64_t));
  std::byte* const parts = bytes.data() + sizeof header;
  std::memcpy(bytes.data(), &header, sizeof header);
  std::copy(snapshot.executed.begin(), snapshot.executed.end(),
            std::copy(snapshot.adjusted.begin(), snapshot.adjusted.end(), parts));
  const std::uint64_t crc = Crc64(std::span(bytes).first(body));
  std::memcpy(bytes.data() + body, &crc, sizeof crc);
  return bytes;
}

std::string DecodeSnapshot(std::span<const std::byte> bytes, std::uint64_t identity, Snapshot* snapshot) {
  Header header{};
  if (bytes.size() < sizeof kMagic || std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0) {
    if (bytes.empty()) return "is empty";
    return MayBeSnapshot(bytes) ? "is damaged: its first bytes are wrong" : "is not a snapshot of an estimator";
  }
  if (bytes.size() < sizeof header + sizeof(std::uint64_t)) return "is truncated";
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.version < kOldestSnapshotVersion || header.version > kSnapshotVersion) {
    return "has version " + std::to_string(header.version) +
           (header.version > kSnapshotVersion ? " of a newer program" : "") + ", expected " +
           std::to_string(kSnapshotVersion);
  }
  const std::size_t whole =
      sizeof header + std::size_t{header.adjusted_size} + std::size_t{header.executed_size} + sizeof(std::uint64_t);
  if (bytes.size() < whole) return "is truncated";
  if (bytes.size() > whole) return "is damaged: it is too long";
  std::uint64_t crc = 0;
  const auto body = bytes.first(whole - sizeof crc);
  std::memcpy(&crc, bytes.data() + body.size(), sizeof crc);
  if (crc != Crc64(body)) return "is damaged: its checksum is wrong";
  if (header.identity != identity) return "belongs to another model, or to other priors, bounds or noise";
  const auto parts = body.subspan(sizeof header);
  const auto adjusted = parts.first(header.adjusted_size);
  const auto executed = parts.subspan(header.adjusted_size);
  snapshot->identity = header.identity;
  snapshot->seq = header.seq;
  snapshot->utime = header.utime;
  snapshot->adjusted.assign(adjusted.begin(), adjusted.end());
  snapshot->executed.assign(executed.begin(), executed.end());
  return "";
}

bool MayBeSnapshot(std::span<const std::byte> bytes) {
  const auto first = bytes.first(std::min(bytes.size(), sizeof kMagic));
  std::size_t right = 0, zero = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    right += first[i] == static_cast<std::byte>(kMagic[i]) ? 1U : 0U;
    zero += first[i] == std::byte{0} ? 1U : 0U;
  }
  if (2 * right >= first.size() || zero == first.size()) return true;
  std::uint32_t version = 0;
  if (bytes.size() < sizeof kMagic + sizeof version) return false;
  std::memcpy(&version, bytes.data() + sizeof kMagic, sizeof version);
  return version >= 1 && version <= kSnapshotVersion;
}

std::string ReplaceFile(const std::string& path, std::span<const std::byte> bytes) {
  const std::string temporary = path + ".tmp";
  if (!WriteNew(temporary, bytes) || std::rename(temporary.c_str(), path.c_str()) != 0) {
    std::string reason = std::strerror(errno);
    (void)::unlink(temporary.c_str());
    return reason;
  }
  // The new name lasts only when the folder is on the disk, too.
  const std::string folder = std::filesystem::absolute(path).parent_path().string();
  const File directory(folder.c_str(), O_RDONLY | O_DIRECTORY);
  if (!directory.is_open() || ::fsync(directory.fd()) != 0) return std::strerror(errno);
  return "";
}

std::string ReadFile(const std::string& path, std::vector<std::byte>* bytes) {
  const File file(path.c_str(), O_RDONLY);
  if (!file.is_open()) return std::strerror(errno);
  bytes->clear();
  std::array<std::byte, 65'536> piece;
  while (true) {
    const ssize_t n = ::read(file.fd(), piece.data(), piece.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return std::strerror(errno);
    if (n == 0) return "";
    bytes->insert(bytes->end(), piece.begin(), piece.begin() + n);
    if (bytes->size() > kLargestFile) return "larger than any snapshot";
  }
}

}  // namespace armcmc::app
