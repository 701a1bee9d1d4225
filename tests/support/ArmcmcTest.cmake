# armcmc_add_tests(GROUP source... [LIBS target...] [INCLUDES folder...] [PROGRAMS target...] [KERNELS] [TIMEOUT
#                  seconds] [COST seconds] [THREADS] [REALTIME] [DEADLINES] [BROWSER] [SCREEN] [NATIVE] [LONG])
#
# Adds test sources to the one GoogleTest executable of a group, GROUP_test; every TEST is a test of ctest with the
# label GROUP. Tests find recordings and programs through "support/paths.hpp", under ctest as well as by hand. Tests
# with parameters name them by the last argument of INSTANTIATE_TEST_SUITE_P: their values are not printed into names.
#
#   LIBS, INCLUDES  what the sources need beyond GoogleTest and tests/support
#   PROGRAMS        programs that the tests run
#   KERNELS         the sources see the private headers of core, and the instruction sets that it was built with
#   TIMEOUT         of one TEST, 60 s if not given
#   COST            seconds that the slowest of them takes, about: ctest starts the most expensive first
#   THREADS         part of the build with ThreadSanitizer
#   REALTIME        part of the build with RealtimeSanitizer
#   DEADLINES       runs programs that have deadlines, in real time: one such test at a time, as two would make each
#                   other miss; not instrumented, as instrumented code is too slow for deadlines
#   BROWSER         opens pages in a browser, which is not ours to instrument: run by `tools/test --all`
#   SCREEN          draws on a screen without a monitor: run by `tools/test --all`
#   NATIVE          what runs is not ours, or runs under AddressSanitizer in other tests
#   LONG            shows what only chance or a long load can show: run by `tools/test --long` alone. So does a single
#                   suite, or an instantiation of one, whose name begins with Long
#
# A build with a sanitizer compiles only what it runs, and runs each executable as a whole, as one test of ctest (two
# for a group that armcmc_split_group names): starting an instrumented program a thousand times takes longer than what most
# tests do.
add_custom_target(all_tests)
set(armcmc_not_long "GTEST_FILTER=-Long*:*/Long*")  # of a group that runs as a whole

# What the sources of all tests include. One for all: it takes longer to make than any test takes to compile.
function(armcmc_make_test_headers)
  add_library(armcmc_test_headers OBJECT "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/test_headers.cpp")
  target_include_directories(armcmc_test_headers PRIVATE "${PROJECT_SOURCE_DIR}/tests")
  target_link_libraries(armcmc_test_headers PRIVATE Eigen3::Eigen armcmc_warnings GTest::gmock)
  armcmc_set_test_options(armcmc_test_headers)
  target_precompile_headers(armcmc_test_headers PRIVATE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/test_headers.hpp")
endfunction()

# A precompiled header fits only where the options are those it was made with.
function(armcmc_set_test_options target)
  # Tests are compiled more often than they are run: -O1 takes half the time of -O3. The code under test keeps its own.
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release,RelWithDebInfo>:-O1>)
  # For ccache.
  target_compile_options(${target} PRIVATE
    $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>
    "$<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endfunction()

# armcmc_is_admitted(VARIABLE option...): whether tests with these options are part of this build.
function(armcmc_is_admitted variable)
  set(admitted TRUE)
  if(ARMCMC_SANITIZER STREQUAL "address" AND ARGN MATCHES "DEADLINES|BROWSER|SCREEN|NATIVE|LONG")
    set(admitted FALSE)
  elseif(ARMCMC_SANITIZER STREQUAL "thread" AND NOT "THREADS" IN_LIST ARGN)
    set(admitted FALSE)
  elseif(ARMCMC_SANITIZER STREQUAL "realtime" AND NOT "REALTIME" IN_LIST ARGN)
    set(admitted FALSE)
  endif()
  set(${variable} ${admitted} PARENT_SCOPE)
endfunction()

function(armcmc_add_group group)
  set(target ${group}_test)
  add_executable(${target})
  # Beside the programs stands nothing but programs.
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests")
  target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/tests")
  target_link_libraries(${target} PRIVATE armcmc_test_support armcmc_warnings Eigen3::Eigen GTest::gmock GTest::gtest_main)
  armcmc_set_test_options(${target})
  target_precompile_headers(${target} REUSE_FROM armcmc_test_headers)
  # Each test source has a namespace of its own, so that any of them fit into one batch.
  armcmc_compile_in_batches(${target} SIZE 12)
  add_dependencies(all_tests ${target})
  if(ARMCMC_SANITIZER)
    target_sources(${target} PRIVATE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/sanitized_group.cpp")
    add_test(NAME ${group} COMMAND ${target})
    # The whole group, at a tenth of the speed, on a machine that may be busy.
    set_tests_properties(${group} PROPERTIES LABELS ${group} TIMEOUT 3600 COST 100
      ENVIRONMENT "${armcmc_not_long}")
    # What a test runs as a process writes to the same file, and the group over it, at its end.
    if(ARMCMC_COVERAGE)
      set_tests_properties(${group} PROPERTIES
        ENVIRONMENT "${armcmc_not_long};LLVM_PROFILE_FILE=${CMAKE_BINARY_DIR}/coverage/${group}.profraw")
    endif()
  endif()
endfunction()

# armcmc_split_group(GROUP): under a sanitizer, two tests of ctest with every other TEST of the group each. For a group
# that takes longer than all others together, so that it does not keep one processor busy while the other has nothing to do.
function(armcmc_split_group group)
  if(NOT ARMCMC_SANITIZER OR NOT TARGET ${group}_test)
    return()
  endif()
  add_test(NAME ${group}_2 COMMAND ${group}_test)
  foreach(property IN ITEMS LABELS TIMEOUT COST RESOURCE_LOCK)
    get_test_property(${group} ${property} value)
    if(value)
      set_tests_properties(${group}_2 PROPERTIES ${property} "${value}")
    endif()
  endforeach()
  set(index 0)
  foreach(test IN ITEMS ${group} ${group}_2)
    set(environment "${armcmc_not_long};GTEST_TOTAL_SHARDS=2;GTEST_SHARD_INDEX=${index}")
    if(ARMCMC_COVERAGE)
      list(APPEND environment "LLVM_PROFILE_FILE=${CMAKE_BINARY_DIR}/coverage/${test}.profraw")
    endif()
    set_tests_properties(${test} PROPERTIES ENVIRONMENT "${environment}")
    math(EXPR index "${index} + 1")
  endforeach()
endfunction()

# The filter of GoogleTest for all suites of some files.
function(armcmc_filter_of_sources variable)
  set(suites "")
  foreach(source IN LISTS ARGN)
    # A new suite is seen without configuring by hand.
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${source}")
    file(STRINGS "${source}" lines REGEX "^(TEST|TEST_F|TEST_P|TYPED_TEST|RC_GTEST_PROP|RC_GTEST_FIXTURE_PROP)\\(")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^[A-Z_]+\\(([A-Za-z0-9_]+).*" "\\1" suite "${line}")
      list(APPEND suites "${suite}.*" "*/${suite}.*" "${suite}/*")
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES suites)
  list(JOIN suites ":" filter)
  set(${variable} "${filter}" PARENT_SCOPE)
endfunction()

function(armcmc_add_tests group)
  set(marks THREADS REALTIME DEADLINES BROWSER SCREEN NATIVE LONG)
  cmake_parse_arguments(PARSE_ARGV 1 arg "KERNELS;${marks}" "TIMEOUT;COST" "LIBS;INCLUDES;PROGRAMS")
  set(sources "${arg_UNPARSED_ARGUMENTS}")
  set(has "")
  foreach(mark IN LISTS marks)
    if(arg_${mark})
      list(APPEND has ${mark})
    endif()
  endforeach()
  armcmc_is_admitted(admitted ${has})
  if(NOT admitted)
    return()
  endif()

  set(target ${group}_test)
  if(NOT TARGET ${target})
    armcmc_add_group(${group})
  endif()
  list(TRANSFORM sources PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/" REGEX "^[^/]")
  target_sources(${target} PRIVATE ${sources})
  target_link_libraries(${target} PRIVATE ${arg_LIBS})
  target_include_directories(${target} PRIVATE ${arg_INCLUDES})
  if(arg_KERNELS)
    target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/core/src")
    target_compile_definitions(${target} PRIVATE $<TARGET_PROPERTY:armcmc_core,COMPILE_DEFINITIONS>)
  endif()
  foreach(program IN LISTS arg_PROGRAMS)
    if(TARGET ${program})
      add_dependencies(${target} ${program})
    endif()
  endforeach()
  if(ARMCMC_SANITIZER)
    # The groups with the longest tests start first.
    if(arg_TIMEOUT)
      set_tests_properties(${group} PROPERTIES COST ${arg_TIMEOUT})
    endif()
    if(arg_DEADLINES)
      set_tests_properties(${group} PROPERTIES RESOURCE_LOCK deadlines)
    endif()
    return()
  endif()

  set(labels ${group})
  foreach(mark IN LISTS has)
    string(TOLOWER "${mark}" label)
    list(APPEND labels ${label})
  endforeach()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 60)
  endif()
  if(CMAKE_CROSSCOMPILING_EMULATOR)
    math(EXPR arg_TIMEOUT "20 * ${arg_TIMEOUT}")  # what is emulated takes that much longer
  endif()
  set(properties TIMEOUT ${arg_TIMEOUT})
  if(arg_DEADLINES)
    # They wait for one another: the first has to start with the first of all.
    list(APPEND properties RESOURCE_LOCK deadlines COST 1000)
  elseif(arg_COST)
    list(APPEND properties COST ${arg_COST})
  endif()
  armcmc_filter_of_sources(filter ${sources})
  # A list does not survive the way through gtest_discover_tests, so the labels are set where ctest reads the tests.
  string(MAKE_C_IDENTIFIER "${group}_${sources}" id)
  string(MD5 id "${id}")
  set(list_name tests_${id})
  gtest_discover_tests(${target} TEST_FILTER "${filter}" DISCOVERY_TIMEOUT 120 NO_PRETTY_VALUES TEST_LIST ${list_name}
    PROPERTIES ${properties})
  set(labels_file "${CMAKE_CURRENT_BINARY_DIR}/labels_${id}.cmake")
  file(WRITE "${labels_file}" "if(${list_name})\n"
    "  set_tests_properties(\${${list_name}} PROPERTIES LABELS \"${labels}\")\n"
    "  set(long \${${list_name}})\n"
    "  list(FILTER long INCLUDE REGEX \"^Long|/Long\")\n"
    "  if(long)\n    set_tests_properties(\${long} PROPERTIES LABELS \"${labels};long\")\n  endif()\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${labels_file}")
endfunction()
