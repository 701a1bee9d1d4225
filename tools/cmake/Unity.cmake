# Compiles the sources of a library in batches: reading Eigen and the standard library, and making their templates, takes
# most of the time of a source file here. ON in the presets; OFF compiles each file by itself, as clang-tidy wants it.
option(ARMCMC_UNITY "Compile the sources of libraries in batches" OFF)

# armcmc_compile_in_batches(TARGET...): those that are part of this build
function(armcmc_compile_in_batches)
  foreach(target IN LISTS ARGN)
    if(ARMCMC_UNITY AND TARGET ${target})
      set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 12)
      # What a batch includes looks like a header to g++, which warns of types in headers that no other file can name.
      target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
    endif()
  endforeach()
endfunction()
