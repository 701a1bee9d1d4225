#include "row_program.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

namespace armcmc::gap {
namespace {

using expression::Op;
using identify::kLanes;
using identify::kTile;
using identify::Lanes;
using identify::Varies;

constexpr auto kRowsAWalk = static_cast<Eigen::Index>(kTile * kLanes);

/// Functions with memory that the outputs read, without those inside of others.
std::vector<int> MemoriesOf(const expression::Graph& graph, const std::vector<int>& outputs) {
  std::vector<bool> needed(static_cast<std::size_t>(graph.size()), false);
  for (const int output : outputs) needed[static_cast<std::size_t>(output)] = true;
  std::vector<int> memories;
  for (int n = graph.size() - 1; n >= 0; --n) {
    if (!needed[static_cast<std::size_t>(n)]) continue;
    const expression::GraphNode& node = graph.at(n);
    if (expression::InfoOf(node.op).memory)
      memories.push_back(n);
    else
      for (const int argument : node.argument)
        if (argument >= 0) needed[static_cast<std::size_t>(argument)] = true;
  }
  return memories;
}

/// `series` a time of `samples` earlier, linear between samples; before the first sample its value there.
Vector Earlier(const Vector& series, double samples) {
  const auto whole = static_cast<Eigen::Index>(std::clamp(samples, 0.0, static_cast<double>(series.size())));
  const double part = std::max(samples, 0.0) - static_cast<double>(whole);
  Vector earlier(series.size());
  for (Eigen::Index i = 0; i < series.size(); ++i) {
    const Eigen::Index near = std::max<Eigen::Index>(i - whole, 0), far = std::max<Eigen::Index>(i - whole - 1, 0);
    earlier[i] = (1.0 - part) * series[near] + part * series[far];
  }
  return earlier;
}

}  // namespace

RowProgram::RowProgram(expression::Graph* graph, std::vector<int> outputs) : num_outputs_(outputs.size()) {
  std::map<int, int> symbols;
  for (const int memory : MemoriesOf(*graph, outputs)) {
    const expression::GraphNode node = graph->at(memory);
    const bool delays = node.op == Op::kDelay && !graph->at(node.argument[1]).varies;
    if ((node.op != Op::kPrevious && !delays) || pasts_.size() == static_cast<std::size_t>(kMostPasts))
      throw std::invalid_argument(std::string(expression::InfoOf(node.op).name) +
                                  " is not available here: use a state");
    symbols[memory] = graph->Symbol(expression::SymbolKind::kSignal, kFirstPast + static_cast<int>(pasts_.size()));
    std::vector<int> of{node.argument[0]};
    if (delays) of.push_back(node.argument[1]);
    pasts_.push_back({node.op, RowProgram(graph, std::move(of))});
  }
  for (int& output : outputs) output = graph->Substitute(output, symbols);
  std::vector<Varies> varies(static_cast<std::size_t>(kNumFormInputs), Varies::kByBoth);
  std::fill(varies.begin() + kFirstValue, varies.end(), Varies::kByLane);
  program_ = identify::LaneProgram(*graph, outputs, varies);
  for (int i = 0; i < kFirstValue; ++i)
    if (program_.Reads(static_cast<std::size_t>(i))) reads_.push_back(i);
}

bool RowProgram::Reads(int input) const {
  return std::find(reads_.begin(), reads_.end(), input) != reads_.end() ||
         std::any_of(pasts_.begin(), pasts_.end(), [&](const Past& past) { return past.of.Reads(input); });
}

identify::LaneRun RowProgram::Begin(const RowInputs& inputs) const {
  std::array<Lanes, kNumFormInputs> values{};
  for (std::size_t i = 0; i < inputs.value.size(); ++i)
    values[static_cast<std::size_t>(kFirstValue) + i].fill(inputs.value[i]);
  return program_.Begin(values.data(), inputs.dt);
}

std::vector<Vector> RowProgram::Over(RowInputs inputs) const {
  std::vector<Vector> pasts;
  pasts.reserve(pasts_.size());
  for (const Past& past : pasts_) {
    const std::vector<Vector> of = past.of.Over(inputs);
    pasts.push_back(Earlier(of[0], past.op == Op::kPrevious ? 1.0 : of[1][0] / inputs.dt));
  }
  for (std::size_t p = 0; p < pasts.size(); ++p)
    inputs.series[static_cast<std::size_t>(kFirstPast) + p] = pasts[p].data();

  identify::LaneRun run = Begin(inputs);
  std::vector<Lanes> in(static_cast<std::size_t>(kFirstValue) * kTile), out(num_outputs_ * kTile);
  const std::array<double, kTile> no_time{};
  std::vector<Vector> outputs(num_outputs_, Vector(inputs.rows));
  for (Eigen::Index first = 0; first < inputs.rows; first += kRowsAWalk) {
    const Eigen::Index count = std::min(kRowsAWalk, inputs.rows - first);
    for (const int i : reads_)
      std::copy_n(inputs.series[static_cast<std::size_t>(i)] + first, count,
                  in[static_cast<std::size_t>(i) * kTile].data());
    program_.Evaluate(kTile, in.data(), kTile, no_time.data(), &run, out.data());
    for (std::size_t o = 0; o < num_outputs_; ++o) std::copy_n(out[o * kTile].data(), count, &outputs[o][first]);
  }
  return outputs;
}

double RowProgram::AtFirst(RowInputs inputs) const {
  inputs.rows = 1;
  return Over(inputs)[0][0];
}

Vector RowProgram::Recursion(const RowInputs& inputs, int k, double start) const {
  identify::LaneRun run = Begin(inputs);
  std::array<Lanes, kFirstValue> in{};
  Lanes out{};
  out[0] = start;
  const double no_time = 0.0;
  const int state = kFirstState + k;
  Vector z(inputs.rows);
  z[0] = start;
  for (Eigen::Index i = 1; i < z.size(); ++i) {
    for (const int read : reads_)
      in[static_cast<std::size_t>(read)][0] = read == state ? z[i - 1] : inputs.series[static_cast<std::size_t>(read)][i];
    program_.Evaluate(1, in.data(), 1, &no_time, &run, &out);
    z[i] = out[0];
  }
  return z;
}

}  // namespace armcmc::gap
