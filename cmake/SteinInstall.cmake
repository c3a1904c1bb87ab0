# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` puts where, so that other projects can say find_package(stein).
include(CMakePackageConfigHelpers)

set(stein_config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/stein)
set(stein_installed_targets stein)
set(stein_header_filter)
if(STEIN_EXR)
  list(APPEND stein_installed_targets stein_exr)
else()
  set(stein_header_filter PATTERN "exr*.hpp" EXCLUDE)
endif()

install(TARGETS ${stein_installed_targets} EXPORT steinTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/stein DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN *.hpp PATTERN *.h ${stein_header_filter})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(EXPORT steinTargets NAMESPACE stein:: DESTINATION ${stein_config_dir})

# Only static libraries pass what they link on to whoever links them.
get_target_property(stein_library_type stein TYPE)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/steinConfig.cmake.in ${PROJECT_BINARY_DIR}/steinConfig.cmake
  INSTALL_DESTINATION ${stein_config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/steinConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/steinConfig.cmake ${PROJECT_BINARY_DIR}/steinConfigVersion.cmake
  DESTINATION ${stein_config_dir})
