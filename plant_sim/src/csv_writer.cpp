#include "armcmc/plant_sim/csv_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace armcmc::plant_sim {

CsvWriter::CsvWriter(const Scenario& scenario, std::uint64_t seed, const std::string& path)
    : family_(*scenario.family), path_(path), simulation_(scenario, seed), file_(std::fopen(path.c_str(), "w")) {
  if (file_ == nullptr) throw std::runtime_error(path + ": cannot be written: " + std::strerror(errno));
  std::string header = "t";
  for (const ChannelSpec& channel : family_.inputs) header += "," + channel.name;
  header += "," + family_.output.name + "," + family_.target.column;
  for (const std::string& name : family_.truth_names) header += "," + name + "_true";
  std::fprintf(file_.get(), "%s\n", header.c_str());
}

void CsvWriter::WriteRow() {
  std::FILE* file = file_.get();
  const PlantSample& measured = simulation_.measured();
  const PlantSample& truth = simulation_.truth();
  std::fprintf(file, "%.17g", measured.t_s);
  for (std::size_t i = 0; i < family_.inputs.size(); ++i) std::fprintf(file, ",%.17g", measured.inputs[i]);
  std::fprintf(file, ",%.17g,%.17g", measured.output, simulation_.plant().Target(truth));
  const Theta theta = simulation_.plant().Truth(std::min(truth.mode, family_.num_modes() - 1), truth.t_s);
  for (std::size_t i = 0; i < family_.truth_names.size(); ++i) std::fprintf(file, ",%.17g", theta[i]);
  std::fputc('\n', file);
}

void CsvWriter::WriteThrough(long long index) {
  while (simulation_.index() < index) {
    if (!simulation_.Next())
      throw std::runtime_error("the plant left the finite range at t = " + std::to_string(simulation_.truth().t_s) +
                               " s: check the scenario's parameters");
    WriteRow();
  }
  if (std::ferror(file_.get()) != 0) throw std::runtime_error(path_ + ": cannot be written: is the disk full?");
}

void CsvWriter::Close() {
  if (file_ != nullptr && std::fclose(file_.release()) != 0)
    throw std::runtime_error(path_ + ": cannot be written: " + std::strerror(errno));
}

}  // namespace armcmc::plant_sim
