# The interpreter that the Python module is built for, with its headers and NumPy, and pybind11; or what is missing.
#
# A module fits one version of Python. -DPython_EXECUTABLE chooses the interpreter, and so does an active virtual
# environment; otherwise it is Debian's, for which the Debian package is made, also where another one (pyenv) comes first
# on the PATH.
if(NOT Python_EXECUTABLE AND NOT Python_ROOT_DIR AND NOT DEFINED ENV{VIRTUAL_ENV} AND NOT DEFINED ENV{CONDA_PREFIX}
    AND EXISTS "/usr/bin/python3")
  set(Python_EXECUTABLE "/usr/bin/python3" CACHE FILEPATH "The interpreter that the Python module is built for")
endif()
find_package(Python 3.11 COMPONENTS Interpreter Development.Module NumPy)  # 3.11: tomllib
if(NOT Python_FOUND)
  set(missing "")
  foreach(part IN ITEMS "Interpreter=an interpreter of version 3.11 or later" "Development.Module=its headers (python3-dev)"
      "NumPy=NumPy (python3-numpy)")
    string(REGEX MATCH "^([^=]*)=(.*)$" part "${part}")
    if(NOT Python_${CMAKE_MATCH_1}_FOUND)
      string(APPEND missing "\n    ${CMAKE_MATCH_2}")
    endif()
  endforeach()
  message(FATAL_ERROR "ARMCMC_PYTHON: the Python module cannot be built for ${Python_EXECUTABLE} ${Python_VERSION}. Missing:"
    "${missing}\n  tools/install-dependencies --with python installs what Debian's Python needs. For another one: "
    "-DPython_EXECUTABLE=/usr/bin/python3. To leave the module out: -DARMCMC_PYTHON=OFF.")
endif()
set(PYBIND11_FINDPYTHON ON)
find_package(pybind11 2.10 QUIET)
if(NOT pybind11_FOUND)
  message(FATAL_ERROR "ARMCMC_PYTHON: pybind11 2.10 or later is missing (tools/install-dependencies --with python, or "
    "-Dpybind11_DIR=FOLDER). To leave the Python module out: -DARMCMC_PYTHON=OFF.")
endif()
message(STATUS "Python module: for ${Python_EXECUTABLE}, Python ${Python_VERSION}")
