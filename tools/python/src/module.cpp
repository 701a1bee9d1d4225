// The compiled part of the Python package armcmc; what users call is in ../armcmc/.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <exception>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "armcmc/plant/error.hpp"
#include "armcmc/support/estimator_config.hpp"
#include "armcmc/support/model_file.hpp"
#include "armcmc/support/plant_library.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/shared_files.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "python_estimator.hpp"
#include "to_python.hpp"

namespace armcmc::python {
namespace {

namespace py = pybind11;
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A name that nothing has is answered with those that there are.
void CheckName(const std::string& model) {
  if (support::IsModelFile(model)) return;
  try {
    (void)BuiltinSettings(model);
  } catch (const std::invalid_argument&) {
    (void)support::FindPlantFile(model);
  }
}

/// As armcmc-replay reads them: tables on which no estimate depends are left to the programs.
EstimatorSettings Settings(support::StrictTable root, const std::string& model) {
  CheckName(model);
  EstimatorSettings settings = support::ReadEstimatorSettings(root, model);
  for (const char* key : {"timing", "rt", "lcm", "gap_log"}) root.LeaveToOthers(key);
  root.Finish();
  return settings;
}

std::unique_ptr<PythonEstimator> FromFile(const std::string& model, const std::string& config) {
  return std::make_unique<PythonEstimator>(
      Settings(support::StrictTable::FromFile(support::FindSharedFile("config", config)), model));
}

std::unique_ptr<PythonEstimator> FromText(const std::string& model, const std::string& text, const std::string& name) {
  return std::make_unique<PythonEstimator>(Settings(support::StrictTable::FromText(text, name), model));
}

std::string ShapeText(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i) text += (i > 0 ? ", " : "") + std::to_string(array.shape(i));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

py::dict Step(PythonEstimator& estimator, const Numbers& u, const Numbers& y, double dt,
              const std::optional<double>& t_last) {
  const std::string inputs = std::to_string(estimator.estimator().num_inputs());
  if (y.ndim() != 1)
    throw std::invalid_argument("y has shape " + ShapeText(y) + ", expected (samples,): one output for each sample");
  if (u.ndim() != 2)
    throw std::invalid_argument("u has shape " + ShapeText(u) + ", expected (samples, " + inputs +
                                "): one row for each sample, one column for each of estimator.inputs");
  if (u.shape(0) != y.shape(0))
    throw std::invalid_argument("u has " + std::to_string(u.shape(0)) + " rows and y " + std::to_string(y.shape(0)) +
                                " samples: give both the same number");
  if (y.shape(0) > std::numeric_limits<int>::max() || u.shape(1) > std::numeric_limits<int>::max())
    throw std::invalid_argument("u and y are too large: cut the data into packs and call step() for each");
  if (t_last && std::isnan(*t_last))
    throw std::invalid_argument("t_last is not a number: leave it out, or give the time of the last sample in seconds");
  const Samples samples{u.data(), y.data(), static_cast<int>(y.shape(0)), static_cast<int>(u.shape(1))};
  Estimate estimate;
  {
    const py::gil_scoped_release others_may_run;
    estimate = estimator.Step(samples, dt, t_last.value_or(std::nan("")));
  }
  return ToDict(estimate, estimator.estimator());
}

py::tuple Draws(PythonEstimator& estimator, int mode) {
  DrawTable table;
  {
    const py::gil_scoped_release others_may_run;
    table = estimator.Draws(mode);
  }
  return ToArrays(table);
}

py::list SignalList(const std::vector<Signal>& signals) {
  py::list out;
  for (const Signal& signal : signals) {
    py::dict one;
    one["name"] = signal.name;
    one["unit"] = signal.unit;
    out.append(std::move(one));
  }
  return out;
}

/// tp_new of Estimator: an object made without from_file() or from_text() would hold no estimator, and pybind11 would
/// give its methods memory that nothing was constructed in. Those two do not come through here.
PyObject* RefuseNew(PyTypeObject* /*type*/, PyObject* /*arguments*/, PyObject* /*keywords*/) {
  PyErr_SetString(PyExc_TypeError, "an estimator is made by armcmc.Estimator(model), not by __new__()");
  return nullptr;
}

/// What is wrong with an input is a ValueError; words of a command line are not for Python.
void Translate(std::exception_ptr error) {
  const auto say = [](const std::exception& e) {
    std::string text = e.what();
    const std::string option = "--model ";
    if (text.starts_with(option)) text = "model " + text.substr(option.size());
    // Names of files are any bytes.
    PyObject* words = PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "backslashreplace");
    if (words == nullptr) return;  // with the error set
    PyErr_SetObject(PyExc_ValueError, words);
    Py_DECREF(words);
  };
  try {
    if (error) std::rethrow_exception(std::move(error));
  } catch (const support::ConfigError& e) {
    say(e);
  } catch (const support::InputError& e) {
    say(e);
  } catch (const PlantError& e) {
    say(e);
  }
}

}  // namespace
}  // namespace armcmc::python

PYBIND11_MODULE(_armcmc, m) {
  namespace py = pybind11;
  using namespace armcmc;
  using python::PythonEstimator;
  py::register_exception_translator(python::Translate);
  m.attr("version") = support::Version();
  m.attr("max_pack_samples") = kMaxPackSamples;
  m.def("use_shared_prefix", [](const std::string& prefix) { support::UseSharedPrefix(prefix); });
  m.def("plant_names", &support::PlantNames);
  m.def("config_path",
        [](const std::string& name) { return py::bytes(support::FindSharedFile("config", name).string()); });
  const py::custom_type_setup no_new([](PyHeapTypeObject* type) { type->ht_type.tp_new = python::RefuseNew; });
  py::class_<PythonEstimator>(m, "Estimator", no_new)
      .def_static("from_file", &python::FromFile)
      .def_static("from_text", &python::FromText)
      .def("step", &python::Step)
      .def("draws", &python::Draws)
      .def("draw_columns",
           [](const PythonEstimator& e, int mode) {
             py::list names;
             for (const python::DrawColumn& column : e.DrawColumns(mode)) names.append(column.name);
             return names;
           })
      .def("reset", &PythonEstimator::Reset, py::call_guard<py::gil_scoped_release>())
      .def("inputs", [](const PythonEstimator& e) { return python::SignalList(e.Inputs()); })
      .def("output", [](const PythonEstimator& e) { return python::SignalList({e.Output()})[0].cast<py::dict>(); })
      .def("parameters", [](const PythonEstimator& e) { return python::ParameterList(e.sampled(), e); });
}
