# armcmc_embed_text(TARGET FUNCTION FILE)
#
# Compiles a text file into TARGET as `std::string_view armcmc::embedded::FUNCTION() noexcept`, declared by the
# sources that use it. The file is read while building, so that an edited one is compiled again.
if(CMAKE_SCRIPT_MODE_FILE)
  file(READ "${INPUT}" text)
  file(WRITE "${OUTPUT}" "// Made from ${INPUT}\n#include <string_view>\n\n"
    "#pragma GCC diagnostic ignored \"-Woverlength-strings\"\n\n"
    "namespace armcmc::embedded {\n"
    "std::string_view ${FUNCTION}() noexcept;\n"
    "std::string_view ${FUNCTION}() noexcept {\n  return R\"ARMCMC_TEXT(${text})ARMCMC_TEXT\";\n}\n"
    "}  // namespace armcmc::embedded\n")
  return()
endif()

set(ARMCMC_EMBED_TEXT_SCRIPT "${CMAKE_CURRENT_LIST_FILE}")
function(armcmc_embed_text target function file)
  set(output "${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp")
  add_custom_command(OUTPUT "${output}"
    COMMAND "${CMAKE_COMMAND}" "-DINPUT=${file}" "-DOUTPUT=${output}" "-DFUNCTION=${function}"
      -P "${ARMCMC_EMBED_TEXT_SCRIPT}"
    DEPENDS "${file}" "${ARMCMC_EMBED_TEXT_SCRIPT}" VERBATIM)
  target_sources(${target} PRIVATE "${output}")
endfunction()
