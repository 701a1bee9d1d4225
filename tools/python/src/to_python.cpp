#include "to_python.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace armcmc::python {
namespace {

namespace py = pybind11;

py::str Text(std::string_view text) { return {text.data(), text.size()}; }

const char* Word(Decision decision) {
  switch (decision) {
    case Decision::kHold: return "hold";
    case Decision::kReinforcement: return "reinforcement";
    case Decision::kModification: return "modification";
  }
  return "";
}

py::array_t<double> Array(const double* values, std::size_t size) {
  return py::array_t<double>(static_cast<py::ssize_t>(size), values);
}

py::dict QuantityDict(const ReportedQuantity& quantity, const MarginalSummary& m) {
  std::vector<double> edges(kHistogramBins + 1);
  for (std::size_t i = 0; i < edges.size(); ++i)
    edges[i] = m.histogram_lo + (m.histogram_hi - m.histogram_lo) * static_cast<double>(i) / kHistogramBins;
  const std::array<double, 5> quantiles = {m.q025, m.q25, m.q50, m.q75, m.q975};
  py::dict out;
  out["name"] = Text(quantity.name);
  out["unit"] = Text(quantity.unit);
  out["mean"] = m.ar_ap;
  out["map"] = m.ar_map;
  out["sd"] = m.sd;
  out["chain_mean"] = m.chain_mean;
  out["quantiles"] = Array(quantiles.data(), quantiles.size());
  out["histogram"] = py::make_tuple(Array(edges.data(), edges.size()), Array(m.density.data(), m.density.size()));
  return out;
}

py::dict ModeDict(int mode, const Estimate& e, const Estimator& estimator) {
  const ModeEstimate& m = e.modes[static_cast<std::size_t>(mode)];
  py::dict out;
  out["name"] = Text(estimator.mode_name(mode));
  out["known"] = m.known;
  out["updated"] = m.updated;
  out["decision"] = Word(m.decision);
  out["num_samples"] = m.num_samples;
  out["draws"] = m.draws;
  out["kish_ess"] = m.kish_ess;
  out["ess"] = m.ess;
  out["acceptance"] = m.acceptance;
  out["log_evidence"] = m.log_evidence;
  out["p_changed"] = m.p_changed;
  out["p_drifted"] = m.p_drifted;
  out["noise_std"] = m.noise_std;
  py::dict quantities;
  for (int r = 0; r < e.num_reported; ++r) {
    const ReportedQuantity quantity = estimator.reported(r);
    quantities[Text(quantity.name)] = QuantityDict(quantity, m.marginal[static_cast<std::size_t>(r)]);
  }
  out["quantities"] = quantities;
  return out;
}

}  // namespace

py::dict ToDict(const Estimate& e, const Estimator& estimator) {
  py::dict out;
  out["seq"] = e.seq;
  out["t_last"] = e.t_last_s;
  out["mode"] = Text(estimator.mode_name(e.mode));
  out["report_mode"] = e.report_mode;
  py::list modes;
  for (int m = 0; m < e.num_modes; ++m) modes.append(ModeDict(m, e, estimator));
  out["modes"] = modes;
  out["y_shown"] = Array(e.y_shown.data(), static_cast<std::size_t>(e.num_samples));
  out["y_pred"] = e.y_pred;
  out["y_band"] = py::make_tuple(e.y_lo, e.y_hi);
  out["y_rmse"] = e.y_rmse;
  out["gap_suspected"] = e.gap.suspected;
  return out;
}

py::tuple ToArrays(const DrawTable& table) {
  const auto rows = static_cast<py::ssize_t>(table.weights.size());
  py::array_t<double> values({rows, static_cast<py::ssize_t>(table.num_columns)});
  std::copy(table.values.begin(), table.values.end(), values.mutable_data());
  return py::make_tuple(values, Array(table.weights.data(), table.weights.size()));
}

py::list ParameterList(const EstimatorSettings& sampled, const PythonEstimator& estimator) {
  const std::vector<DrawColumn> columns = estimator.DrawColumns(0);
  py::list out;
  for (std::size_t d = 0; d < static_cast<std::size_t>(sampled.num_parameters); ++d) {
    const ParameterSettings& p = sampled.parameters[d];
    const bool uniform = p.prior == PriorKind::kUniform;
    py::dict one;
    one["name"] = columns[d].name;
    one["unit"] = columns[d].unit;
    one["sampled_as"] = p.name;
    one["prior"] = uniform ? "uniform" : "normal";
    one["mean"] = uniform ? py::object(py::none()) : py::object(py::float_(p.mean));
    one["sd"] = uniform ? py::object(py::none()) : py::object(py::float_(p.sd));
    one["lower"] = p.lower;
    one["upper"] = p.upper;
    out.append(std::move(one));
  }
  return out;
}

}  // namespace armcmc::python
