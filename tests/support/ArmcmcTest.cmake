# armcmc_add_test(NAME source... LIBS target... [LABELS label...] [TIMEOUT seconds] [SERIAL])
#
# A GoogleTest executable, every TEST of it a test of ctest. Tests find recordings and programs through
# "support/paths.hpp", under ctest as well as by hand. TIMEOUT (60 s) is per TEST. SERIAL: never
# beside another test, for what needs the processors to itself. Labels default to the folder's name. Tests with
# parameters name them by the last argument of INSTANTIATE_TEST_SUITE_P: their values are not printed into names.
# What tools/test builds for a preset that runs a part of the tests only.
add_custom_target(realtime_tests)      # marked code and the process around it
add_custom_target(tests_with_threads)
set(ARMCMC_GROUPS_OF_core realtime_tests)
set(ARMCMC_GROUPS_OF_rt realtime_tests tests_with_threads)
set(ARMCMC_GROUPS_OF_realtime realtime_tests tests_with_threads)
set(ARMCMC_GROUPS_OF_threads tests_with_threads)

function(armcmc_add_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "SERIAL" "TIMEOUT" "LIBS;LABELS")
  if(NOT arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "armcmc_add_test(${name}): no sources")
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 60)
  endif()
  if(NOT arg_LABELS)
    get_filename_component(arg_LABELS "${CMAKE_CURRENT_SOURCE_DIR}" NAME)
  endif()
  add_executable(${name} ${arg_UNPARSED_ARGUMENTS})
  # Beside the programs stands nothing but programs.
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests")
  target_link_libraries(${name} PRIVATE
    ${arg_LIBS} armcmc_test_support armcmc_warnings GTest::gmock GTest::gtest_main)
  foreach(label IN LISTS arg_LABELS)
    foreach(group IN LISTS ARMCMC_GROUPS_OF_${label})
      add_dependencies(${group} ${name})
    endforeach()
  endforeach()
  # No tests under AddressSanitizer, and built there by name only: the programs that live tests run have deadlines, which
  # instrumented code is too slow for; a browser and what is packed are not ours; "slow" are hundreds of whole runs of
  # code that other tests run, too.
  set(not_with_address ${arg_LABELS})
  list(FILTER not_with_address INCLUDE REGEX "^(live|package|browser|slow)$")
  if(ARMCMC_SANITIZER STREQUAL "address" AND not_with_address)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL TRUE)
    return()
  endif()
  set(properties TIMEOUT ${arg_TIMEOUT})
  if(arg_SERIAL)
    list(APPEND properties RUN_SERIAL TRUE)
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 NO_PRETTY_VALUES TEST_LIST ${name}_tests PROPERTIES ${properties})
  # A list does not survive the way through gtest_discover_tests, so the labels are set where ctest reads the tests.
  set(labels_file "${CMAKE_CURRENT_BINARY_DIR}/${name}_labels.cmake")
  file(WRITE "${labels_file}" "if(${name}_tests)\n"
    "  set_tests_properties(\${${name}_tests} PROPERTIES LABELS \"${arg_LABELS}\")\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${labels_file}")
endfunction()
