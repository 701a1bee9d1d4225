# Instruments everything that is compiled, tests included: a fault may show in either. Set by the presets
# asan, tsan and rtsan.
set(ARMCMC_SANITIZER "" CACHE STRING "address (with undefined), thread, realtime (clang 20 or later), or nothing")
set_property(CACHE ARMCMC_SANITIZER PROPERTY STRINGS "" address thread realtime)
option(ARMCMC_RTSAN "Check the functions marked ARMCMC_NONBLOCKING at compile time and at run time" OFF)

if(ARMCMC_SANITIZER STREQUAL "address")
  # AddressSanitizer sees for itself what goes through a null pointer or past an object; checking it twice takes a quarter
  # of the time that this build compiles.
  set(flags -fsanitize=address,undefined -fno-sanitize=null,object-size,vptr -fno-sanitize-recover=all
    -fno-omit-frame-pointer)
  add_compile_definitions(_GLIBCXX_ASSERTIONS)
elseif(ARMCMC_SANITIZER STREQUAL "thread")
  set(flags -fsanitize=thread -fno-omit-frame-pointer)
elseif(ARMCMC_SANITIZER STREQUAL "realtime")
  set(flags -fsanitize=realtime -fno-omit-frame-pointer)
elseif(ARMCMC_SANITIZER)
  message(FATAL_ERROR "ARMCMC_SANITIZER = ${ARMCMC_SANITIZER}: expected address, thread, realtime or nothing")
endif()
if(ARMCMC_RTSAN)
  if(NOT ARMCMC_SANITIZER STREQUAL "realtime")
    message(FATAL_ERROR "ARMCMC_RTSAN needs ARMCMC_SANITIZER=realtime")
  endif()
  list(APPEND flags -Wfunction-effects)
  add_compile_definitions(ARMCMC_RTSAN=1)
endif()
# The libraries that are counted compile with ${ARMCMC_COVERAGE_OPTIONS}: clang's source-based line coverage.
option(ARMCMC_COVERAGE "Count the lines of core, rt, tools/gap and tools/ladder that tests run (clang)" OFF)
set(ARMCMC_COVERAGE_OPTIONS "")
if(ARMCMC_COVERAGE)
  set(ARMCMC_COVERAGE_OPTIONS -fprofile-instr-generate -fcoverage-mapping)
  add_link_options(-fprofile-instr-generate)
endif()
if(flags)
  add_compile_options(${flags})
  list(FILTER flags INCLUDE REGEX "^-f(no-)?sanitize")
  add_link_options(${flags})
  unset(flags)
endif()
