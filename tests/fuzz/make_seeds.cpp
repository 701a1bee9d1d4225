// make_seeds DIR: one good input for every fuzzer, from which it starts.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/data_pack_t.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/rt/warm_up.hpp"
#include "armcmc/snapshot.hpp"
#include "rt/test_packs.hpp"
#include "snapshot_file.hpp"

namespace {

using Bytes = std::vector<std::uint8_t>;

void Write(const std::filesystem::path& path, const void* data, std::size_t size) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary).write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
}

Bytes Encoded(std::int64_t seq) {
  const armcmc::data_pack_t pack = armcmc::rt::test::ValidPack(seq);
  Bytes bytes(static_cast<std::size_t>(pack.getEncodedSize()));
  pack.encode(bytes.data(), 0, pack.getEncodedSize());
  return bytes;
}

void Append(std::uint64_t value, int size, Bytes* bytes) {
  for (int i = size - 1; i >= 0; --i) bytes->push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void Append(const std::string& text, Bytes* bytes) { bytes->insert(bytes->end(), text.begin(), text.end()); }

void Datagram(const std::filesystem::path& dir) {
  Bytes bytes;
  Append(0x4c433032, 4, &bytes);
  Append(1, 4, &bytes);
  Append("PLANT_PACK", &bytes);
  bytes.push_back(0);
  const Bytes pack = Encoded(1);
  bytes.insert(bytes.end(), pack.begin(), pack.end());
  Write(dir / "datagram/good", bytes.data(), bytes.size());
}

void Log(const std::filesystem::path& dir) {
  Bytes bytes;
  for (std::uint64_t i = 0; i < 3; ++i) {
    const Bytes pack = Encoded(static_cast<std::int64_t>(i) + 1);
    Append(0xeda1da01, 4, &bytes);
    Append(i, 8, &bytes);
    Append(1'000'000 + i, 8, &bytes);
    Append(10, 4, &bytes);
    Append(pack.size(), 4, &bytes);
    Append("PLANT_PACK", &bytes);
    bytes.insert(bytes.end(), pack.begin(), pack.end());
  }
  Write(dir / "log/good", bytes.data(), bytes.size());
}

void Csv(const std::filesystem::path& dir) {
  std::string contact = std::string(1, '\0') + "# a comment\nt,x,v,f\n";
  std::string actuator = std::string(1, '\3') + "t,u_c,u_d,p,pdot,alpha\n";
  for (int i = 0; i < 12; ++i) {
    const std::string t = std::to_string(0.001 * i);
    contact += t + ",0.5,1e-1,2.25\n";
    actuator += t + ",0.5,0,101325,12,0.1\n";
  }
  Write(dir / "csv/contact", contact.data(), contact.size());
  Write(dir / "csv/actuator", actuator.data(), actuator.size());
}

void Config(const std::filesystem::path& dir) {
  std::filesystem::create_directories(dir / "config");
  for (const auto& entry : std::filesystem::directory_iterator(ARMCMC_CONFIG_DIR))
    std::filesystem::copy_file(entry.path(), dir / "config" / entry.path().filename(),
                               std::filesystem::copy_options::overwrite_existing);
}

void Snapshot(const std::filesystem::path& dir) {
  auto settings = armcmc::BuiltinSettings("hunt_crossley");
  armcmc::Estimator estimator(settings);
  const auto result = estimator.MakeResult();
  const auto estimate = std::make_unique<armcmc::Estimate>();
  for (int i = 0; i < 3; ++i) {
    const auto pack = armcmc::rt::SyntheticPack(armcmc::rt::PackFormatOf(estimator), i);
    (void)estimator.Adjust(pack, 0, armcmc::ClockRef{}, result.get());
    estimator.Execute(*result, estimate.get());
  }
  armcmc::app::Snapshot snapshot;
  snapshot.identity = armcmc::SnapshotIdentity(settings);
  snapshot.adjusted.resize(armcmc::Estimator::kSnapshotBytes);
  snapshot.executed.resize(armcmc::Estimator::kSnapshotBytes);
  snapshot.adjusted.resize(estimator.SaveAdjusted(snapshot.adjusted));
  snapshot.executed.resize(estimator.SaveExecuted(snapshot.executed));
  const auto bytes = armcmc::app::EncodeSnapshot(snapshot);
  Write(dir / "snapshot/good", bytes.data(), bytes.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  Datagram(argv[1]);
  Log(argv[1]);
  Csv(argv[1]);
  Config(argv[1]);
  Snapshot(argv[1]);
  return 0;
}
