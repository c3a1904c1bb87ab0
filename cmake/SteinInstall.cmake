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
install(FILES ${PROJECT_SOURCE_DIR}/include/stein.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(EXPORT steinTargets NAMESPACE stein:: DESTINATION ${stein_config_dir})

# Only static libraries pass what they link on to whoever links them.
get_target_property(stein_library_type stein TYPE)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/steinConfig.cmake.in ${PROJECT_BINARY_DIR}/steinConfig.cmake
  INSTALL_DESTINATION ${stein_config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/steinConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/steinConfig.cmake ${PROJECT_BINARY_DIR}/steinConfigVersion.cmake
  DESTINATION ${stein_config_dir})

# For pkg-config: the C and C++ interface without files. It finds itself wherever the tree is moved. Where stein is a
# static library, what it is linked to comes with it, the C++ runtime for C programs included.
set(stein_pc_requires)
set(stein_pc_libs)
if(stein_library_type STREQUAL "STATIC_LIBRARY")
  set(stein_pc_requires "Requires: tbb libhwy")
  set(stein_runtime ${CMAKE_CXX_IMPLICIT_LINK_LIBRARIES})
  list(REMOVE_ITEM stein_runtime gcc gcc_s c)
  list(REMOVE_DUPLICATES stein_runtime)
  list(TRANSFORM stein_runtime PREPEND -l)
  list(JOIN stein_runtime " " stein_runtime)
  set(stein_pc_libs "${stein_runtime} ${CMAKE_THREAD_LIBS_INIT}")
endif()
file(RELATIVE_PATH stein_pc_prefix ${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" stein_pc_prefix "${stein_pc_prefix}")
configure_file(${PROJECT_SOURCE_DIR}/cmake/stein.pc.in ${PROJECT_BINARY_DIR}/stein.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/stein.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
