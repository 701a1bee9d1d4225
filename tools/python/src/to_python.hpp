#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "armcmc/estimate.hpp"
#include "python_estimator.hpp"

namespace armcmc::python {

/// What README.md beside lists, as dicts of numbers and arrays.
[[nodiscard]] pybind11::dict ToDict(const Estimate& estimate, const Estimator& estimator);

/// (samples, weights): arrays of their own.
[[nodiscard]] pybind11::tuple ToArrays(const DrawTable& table);

/// One dict for each sampled parameter: name, unit, and its prior.
[[nodiscard]] pybind11::list ParameterList(const EstimatorSettings& sampled, const PythonEstimator& estimator);

}  // namespace armcmc::python
