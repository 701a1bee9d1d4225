#include "recorded_source.hpp"

#include <armcmc/support/strict_toml.hpp>
#include <string_view>

namespace armcmc::embedded {
std::string_view RecordedMotions() noexcept;
}  // namespace armcmc::embedded

namespace armcmc::gap_bench {
namespace {

RecordedSource ReadSource(support::StrictTable* table) {
  RecordedSource source;
  source.name = table->RequiredText("name");
  source.file = table->RequiredText("file");
  source.time = table->RequiredText("time");
  source.second = table->Number("second", source.second, 1e-12, 1e6);
  source.until_s = table->Number("until_s", source.until_s, 0.0, 1e12);
  const std::vector<std::string> columns = table->Texts("columns");
  if (columns.empty()) throw table->Error("columns", "expected at least one column");
  const std::vector<double> ones(columns.size(), 1.0);
  const std::vector<double> factors = table->Numbers("factors", ones, columns.size(), columns.size(), -1e300, 1e300);
  for (std::size_t c = 0; c < columns.size(); ++c) source.columns.emplace_back(columns[c], factors[c]);
  return source;
}

}  // namespace

RecordedSources ReadRecordedSources() {
  support::StrictTable root = support::StrictTable::FromText(embedded::RecordedMotions(), "motions.toml");
  root.RequireSchema();
  RecordedSources sources;
  for (support::StrictTable& table : root.Tables("motion")) sources.motions.push_back(ReadSource(&table));
  support::StrictTable noise = root.Table("noise");
  sources.noise = ReadSource(&noise);
  root.Finish();
  return sources;
}

}  // namespace armcmc::gap_bench
