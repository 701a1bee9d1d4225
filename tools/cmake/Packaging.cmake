# Installed: libraries with headers for find_package(armcmc), man pages, the service. `cpack -G DEB` makes a package.
include(CMakePackageConfigHelpers)
set(armcmc_cmake_dir "${CMAKE_INSTALL_LIBDIR}/cmake/armcmc")

set(armcmc_libraries armcmc_warnings armcmc_core armcmc_lcm_types)
install(DIRECTORY "${PROJECT_BINARY_DIR}/lcm_types/gen/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/lcm_types/" DESTINATION "${CMAKE_INSTALL_DATADIR}/armcmc/lcm_types"
  FILES_MATCHING PATTERN "*.lcm" PATTERN spy EXCLUDE)
if(TARGET armcmc_rt)
  list(APPEND armcmc_libraries armcmc_rt)
endif()
install(TARGETS ${armcmc_libraries} EXPORT armcmcTargets
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" FILE_SET HEADERS)
install(EXPORT armcmcTargets NAMESPACE armcmc:: DESTINATION "${armcmc_cmake_dir}")
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/armcmcConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/armcmcConfig.cmake" INSTALL_DESTINATION "${armcmc_cmake_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/armcmcConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/armcmcConfig.cmake" "${PROJECT_BINARY_DIR}/armcmcConfigVersion.cmake"
  "${CMAKE_CURRENT_LIST_DIR}/FindLCM.cmake" DESTINATION "${armcmc_cmake_dir}")

# The manual page of a program and its shell completion are made from its --help.
foreach(program IN ITEMS armcmc-bench armcmc-estimator armcmc-export armcmc-gap armcmc-gap-bench armcmc-model armcmc-plant
    armcmc-replay armcmc-rtcheck armcmc-spy armcmc-stress armcmc-tables armcmc-watch)
  set(executable "$<TARGET_FILE:${program}>")
  set(made_by "${program}")
  if(program STREQUAL "armcmc-spy")  # a script, written when CMake runs
    set(executable "${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/armcmc-spy")
    set(made_by "${executable}")
  endif()
  if((TARGET ${program} OR program STREQUAL "armcmc-spy") AND NOT CMAKE_CROSSCOMPILING)  # they have to run
    set(page "${PROJECT_BINARY_DIR}/man/${program}.1")
    set(completion "${PROJECT_BINARY_DIR}/completions/${program}")
    foreach(made IN ITEMS page completion)
      set(maker "${PROJECT_SOURCE_DIR}/tools/cmake/man-page")
      if(made STREQUAL "completion")
        set(maker "${PROJECT_SOURCE_DIR}/tools/cmake/bash-completion")
      endif()
      add_custom_command(OUTPUT "${${made}}" COMMAND "${maker}" "${executable}" "${${made}}"
        DEPENDS "${made_by}" "${maker}" VERBATIM)
    endforeach()
    list(APPEND armcmc_man_pages "${page}")
    list(APPEND armcmc_completions "${completion}")
  endif()
endforeach()
if(armcmc_man_pages)
  add_custom_target(armcmc_man ALL DEPENDS ${armcmc_man_pages} ${armcmc_completions})
  install(FILES ${armcmc_man_pages} DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
  install(FILES ${armcmc_completions} DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions")
endif()

if(TARGET armcmc-estimator)
  install(FILES "${PROJECT_SOURCE_DIR}/rt/deploy/armcmc-estimator.service" DESTINATION lib/systemd/system)
  install(FILES "${PROJECT_SOURCE_DIR}/rt/deploy/60-armcmc.conf" DESTINATION lib/sysctl.d)
  install(FILES "${PROJECT_SOURCE_DIR}/rt/deploy/armcmc.limits.conf" "${PROJECT_SOURCE_DIR}/rt/deploy/armcmc.default"
    "${PROJECT_SOURCE_DIR}/rt/deploy/10-housekeeping.conf" "${PROJECT_SOURCE_DIR}/rt/deploy/60-armcmc.rules"
    DESTINATION "${CMAKE_INSTALL_DATADIR}/armcmc/deploy")
  install(FILES "${PROJECT_SOURCE_DIR}/rt/deploy/tuning.md" "${PROJECT_SOURCE_DIR}/rt/deploy/misses.md"
    "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME armcmc)
set(CPACK_PACKAGE_CONTACT "ARMCMC developers <armcmc@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "liblcm-bin, iproute2")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "liblcm-dev, libeigen3-dev, stress-ng, liblcm-java, libjchart2d-java")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/rt/deploy/debian/postinst"
  "${PROJECT_SOURCE_DIR}/rt/deploy/debian/prerm" "${PROJECT_SOURCE_DIR}/rt/deploy/debian/postrm")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
if(TARGET armcmc_python)
  # A package of its own; what belongs to no component stays the package that it is without Python.
  set(CPACK_DEB_COMPONENT_INSTALL ON)
  set(CPACK_COMPONENTS_ALL Unspecified python)
  set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME armcmc)
  foreach(field IN ITEMS CONTROL_EXTRA RECOMMENDS SUGGESTS)
    set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_${field} ${CPACK_DEBIAN_PACKAGE_${field}})
    unset(CPACK_DEBIAN_PACKAGE_${field})  # none of Python's
  endforeach()
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "The estimator behind numpy arrays")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-armcmc)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS python3-matplotlib)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/tools/python/debian/prerm")
  math(EXPR armcmc_next_python "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "armcmc (= ${PROJECT_VERSION}), python3-numpy, \
python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${armcmc_next_python})")
endif()
include(CPack)
