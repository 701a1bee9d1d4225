# The reference reader of MCAP files in JavaScript, with what it needs, for a test that reads our files with it.
include(NpmPackage)

set(mcap_reader "${PROJECT_BINARY_DIR}/npm/mcap_reader/node_modules")
file(REMOVE_RECURSE "${mcap_reader}")
foreach(package IN ITEMS
    "@mcap/core 2.2.2 5b83458b2a90949b0d8f0f09c40010f3bdaed312d6272d06142dd8166f1b4cb6cdb3e1dd0d67bc0f006ace7af43066295adc3e017f17cc7581e58f6b2c418926"
    "@foxglove/crc 0.0.3 0e3219b272f70b23ffc90fef51803d723ac3d1affc6177a3239666b1a3a24f5e9c2df65c4f0682c48374d7fcace23b32f9d64243ff439d6167ec01056e230368"
    "heap-js 2.7.1 1107decd18343426463658650d1dc4bebc351552f61b72e153b1203e8c6e7d02abb8d052600f0c8913c77966d4fb7ea8f8585e974c0cc0cfac2c488102534b24"
    "tslib 2.8.1 a0916ef781d06fe29576e49440bef09e99aa9df98bb0e03f9c087a6fa107d30084a0ad3f98f79753a737c0a0d5f373243ae1cf447b525ca294f7d2016b34bfdb")
  string(REPLACE " " ";" package "${package}")
  list(GET package 0 name)
  list(GET package 1 version)
  list(GET package 2 hash)
  armcmc_npm_package(${name} ${version} SHA512 ${hash} OUTPUT_DIR unpacked OPTIONAL)
  if(NOT unpacked)
    message(STATUS "Tests: MCAP files are not read with the reference reader")
    file(REMOVE_RECURSE "${mcap_reader}")
    break()
  endif()
  file(COPY "${unpacked}/" DESTINATION "${mcap_reader}/${name}")
endforeach()
