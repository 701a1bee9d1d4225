# armcmc_npm_package(NAME VERSION SHA512 hash OUTPUT_DIR variable [OPTIONAL])
#
# Unpacks one package of the npm registry while configuring; nothing of npm itself is needed. The version is
# pinned and the archive checked against its SHA-512, wherever it came from. OUTPUT_DIR is set to the folder with the
# content of the package. The archive is kept in the build tree, so that only the first configuration needs a network.
#
# OPTIONAL: without a network OUTPUT_DIR is set to an empty text and the configuration goes on.
set(ARMCMC_NPM_REGISTRY "https://registry.npmjs.org" CACHE STRING "Where packages of JavaScript are downloaded from")
set(ARMCMC_NPM_CACHE "" CACHE PATH
  "Folder with archives NAME-VERSION.tgz from the npm registry, used before anything is downloaded")

function(armcmc_npm_package name version)
  cmake_parse_arguments(PARSE_ARGV 2 arg "OPTIONAL" "SHA512;OUTPUT_DIR" "")
  # The archive of @scope/name is called scope-name by `npm pack`, and name by the registry.
  string(REGEX REPLACE "^.*/" "" base_name "${name}")
  string(REGEX REPLACE "^@" "" archive_name "${name}")
  string(REPLACE "/" "-" archive_name "${archive_name}")
  set(file_name "${archive_name}-${version}.tgz")
  set(url "${ARMCMC_NPM_REGISTRY}/${name}/-/${base_name}-${version}.tgz")
  set(archive "${PROJECT_BINARY_DIR}/npm/${file_name}")
  set(unpacked "${PROJECT_BINARY_DIR}/npm/${archive_name}-${version}")
  set(${arg_OUTPUT_DIR} "${unpacked}/package" PARENT_SCOPE)

  set(way_out "With a network later, try again. Without one: fetch ${url} elsewhere, put it into a folder as "
    "${file_name}, run cmake --preset release -DARMCMC_NPM_CACHE=FOLDER once, and try again. "
    "Another mirror: -DARMCMC_NPM_REGISTRY=URL.")
  string(CONCAT way_out ${way_out})

  file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/npm")
  set(cached "${ARMCMC_NPM_CACHE}/${file_name}")
  if(ARMCMC_NPM_CACHE AND EXISTS "${cached}")
    file(COPY_FILE "${cached}" "${archive}.part" RESULT code)
    set(source "${cached}")
  elseif(EXISTS "${archive}")
    file(COPY_FILE "${archive}" "${archive}.part" RESULT code)
    set(source "${archive}")
  else()
    message(STATUS "Downloading ${url}")
    foreach(attempt RANGE 1 3)
      file(DOWNLOAD "${url}" "${archive}.part" STATUS status INACTIVITY_TIMEOUT 30 TIMEOUT 300 TLS_VERIFY ON)
      list(GET status 0 code)
      list(GET status 1 reason)
      if(code EQUAL 0)
        break()
      endif()
    endforeach()
    if(NOT code EQUAL 0)
      file(REMOVE "${archive}.part")
      set(complaint "The package ${name} ${version} could not be downloaded (${reason}). ${way_out}")
      if(NOT arg_OPTIONAL)
        message(FATAL_ERROR "${complaint}")
      endif()
      message(STATUS "${complaint}")
      set(${arg_OUTPUT_DIR} "" PARENT_SCOPE)
      return()
    endif()
    set(source "${url}")
  endif()
  file(SHA512 "${archive}.part" hash)
  if(NOT hash STREQUAL "${arg_SHA512}")
    file(REMOVE "${archive}.part" "${archive}")
    message(FATAL_ERROR "${source} is not ${name} ${version} as published: its SHA-512 is ${hash}, expected "
      "${arg_SHA512}. ${way_out}")
  endif()
  file(RENAME "${archive}.part" "${archive}")
  if(NOT EXISTS "${unpacked}/package/package.json")
    file(ARCHIVE_EXTRACT INPUT "${archive}" DESTINATION "${unpacked}")
  endif()
endfunction()
