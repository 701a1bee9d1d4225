# The presets make warnings errors: a warning nobody has to read is a warning nobody reads. A build without a preset may
# have another compiler, or no batches, in which g++ 12 warns about the standard library.
option(ARMCMC_WERROR "Treat warnings as errors" OFF)
add_library(armcmc_warnings INTERFACE)
# In a batch of sources a local name may be one of another file's: tools/tidy looks for shadows, file by file.
target_compile_options(armcmc_warnings INTERFACE
  -Wall -Wextra -Wpedantic $<$<NOT:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>:-Wshadow> -Wconversion -Wsign-conversion -Wold-style-cast
  -Wnon-virtual-dtor -Woverloaded-virtual -Wdouble-promotion -Wformat=2 -Wundef
  # A newer clang sees std::stable_sort of libstdc++ 12 call what libstdc++ itself calls deprecated. g++ looks for ours.
  $<$<AND:$<CXX_COMPILER_ID:Clang>,$<VERSION_GREATER_EQUAL:$<CXX_COMPILER_VERSION>,20>>:-Wno-deprecated-declarations>
  $<$<BOOL:${ARMCMC_WERROR}>:-Werror>)
