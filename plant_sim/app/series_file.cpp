#include "series_file.hpp"

#include <armcmc/support/csv.hpp>
#include <armcmc/support/program.hpp>
#include <cmath>
#include <utility>

namespace armcmc::plant_sim {

std::shared_ptr<const Series> ReadSeries(const std::filesystem::path& path, const std::filesystem::path& beside,
                                         const std::string& column) {
  const std::filesystem::path file = beside.parent_path() / path;
  support::CsvRequest request;
  request.columns = {"t", column};
  support::CsvSamples samples = support::ReadCsv(file, request);
  const std::vector<double>& t = samples.columns[0];
  if (t.size() < 2) throw support::InputError(file.string() + ": holds fewer than two samples");
  Series series;
  series.file = std::filesystem::absolute(file).lexically_normal().string();
  series.interval_s = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  constexpr double kJitter = 0.01;  // of the interval
  for (std::size_t i = 0; i < t.size(); ++i)
    if (std::abs(t[i] - t.front() - static_cast<double>(i) * series.interval_s) > kJitter * series.interval_s)
      throw support::InputError(file.string() + ": t is not even at row " + std::to_string(i + 1) +
                                ": resample the recording");
  series.values = std::move(samples.columns[1]);
  return std::make_shared<const Series>(std::move(series));
}

}  // namespace armcmc::plant_sim
