# Compiles the sources of a target in batches: reading Eigen and the standard library, and making their templates, takes
# most of the time of a source file here. ON in the presets; OFF compiles each file by itself, as clang-tidy wants it.
option(ARMCMC_UNITY "Compile sources in batches" OFF)

# armcmc_compile_in_batches(TARGET... [SIZE files]): those that are part of this build
function(armcmc_compile_in_batches)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "SIZE" "")
  if(NOT arg_SIZE)
    set(arg_SIZE 12)
  endif()
  foreach(target IN LISTS arg_UNPARSED_ARGUMENTS)
    if(ARMCMC_UNITY AND TARGET ${target})
      set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${arg_SIZE})
      # What a batch includes looks like a header to g++, which warns of types in headers that no other file can name.
      target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
    endif()
  endforeach()
endfunction()

# armcmc_optimise_little(TARGET...): those that are part of this build. For what reads files and command lines and writes
# tables and pages: -O1 compiles in two thirds of the time of -O3, and what computes is elsewhere.
function(armcmc_optimise_little)
  foreach(target IN LISTS ARGN)
    if(TARGET ${target})
      target_compile_options(${target} PRIVATE $<$<CONFIG:Release,RelWithDebInfo>:-O1>)
    endif()
  endforeach()
endfunction()
