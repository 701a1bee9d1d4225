#include "armcmc/plant_sim/options.hpp"

#include <stdexcept>
#include <utility>

namespace armcmc::plant_sim {
namespace {

template <typename T>
const T& Get(const std::map<std::string, Options::Value>& values, const std::string& key) {
  const auto it = values.find(key);
  if (it == values.end() || !std::holds_alternative<T>(it->second))
    throw std::invalid_argument("the plant has no option " + key + " of that kind");
  return std::get<T>(it->second);
}

}  // namespace

OptionSpec OptionSpec::Number(std::string table, std::string key, double fallback, double lo, double hi) {
  OptionSpec spec;
  spec.table = std::move(table);
  spec.key = std::move(key);
  spec.kind = Kind::kNumber;
  spec.number = fallback;
  spec.lo = lo;
  spec.hi = hi;
  return spec;
}

OptionSpec OptionSpec::List(std::string table, std::string key, std::vector<double> fallback, double lo, double hi) {
  OptionSpec spec = Number(std::move(table), std::move(key), 0.0, lo, hi);
  spec.kind = Kind::kList;
  spec.list = std::move(fallback);
  return spec;
}

OptionSpec OptionSpec::Choice(std::string table, std::string key, std::vector<std::string> choices) {
  OptionSpec spec = Number(std::move(table), std::move(key), 0.0, 0.0, 0.0);
  spec.kind = Kind::kChoice;
  spec.choices = std::move(choices);
  return spec;
}

OptionSpec OptionSpec::Series(std::string table, std::string key, std::string column) {
  OptionSpec spec = Number(std::move(table), std::move(key), 0.0, 0.0, 0.0);
  spec.kind = Kind::kSeries;
  spec.column = std::move(column);
  return spec;
}

Options::Options(const std::vector<OptionSpec>& specs) {
  for (const OptionSpec& spec : specs) {
    switch (spec.kind) {
      case OptionSpec::Kind::kNumber: values_[spec.key] = spec.number; break;
      case OptionSpec::Kind::kList: values_[spec.key] = spec.list; break;
      case OptionSpec::Kind::kChoice: values_[spec.key] = spec.choices.front(); break;
      case OptionSpec::Kind::kSeries: values_[spec.key] = std::shared_ptr<const Series>(); break;
    }
  }
}

void Options::Set(const std::string& key, Value value) {
  const auto it = values_.find(key);
  if (it == values_.end() || it->second.index() != value.index())
    throw std::invalid_argument("the plant has no option " + key + " of that kind");
  it->second = std::move(value);
}

double Options::Number(const std::string& key) const { return Get<double>(values_, key); }
const std::vector<double>& Options::List(const std::string& key) const {
  return Get<std::vector<double>>(values_, key);
}
const std::string& Options::Choice(const std::string& key) const { return Get<std::string>(values_, key); }
const std::shared_ptr<const Series>& Options::Recorded(const std::string& key) const {
  return Get<std::shared_ptr<const Series>>(values_, key);
}

}  // namespace armcmc::plant_sim
