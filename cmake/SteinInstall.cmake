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
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT dev
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/stein DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev
  FILES_MATCHING PATTERN *.hpp PATTERN *.h ${stein_header_filter})
install(FILES ${PROJECT_SOURCE_DIR}/include/stein.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(EXPORT steinTargets NAMESPACE stein:: DESTINATION ${stein_config_dir} COMPONENT dev)

# Only static libraries pass what they link on to whoever links them.
get_target_property(stein_library_type stein TYPE)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/steinConfig.cmake.in ${PROJECT_BINARY_DIR}/steinConfig.cmake
  INSTALL_DESTINATION ${stein_config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/steinConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/steinConfig.cmake ${PROJECT_BINARY_DIR}/steinConfigVersion.cmake
  DESTINATION ${stein_config_dir} COMPONENT dev)

# For pkg-config: stein is the C and C++ interface without files, stein_exr has these as well. They find themselves wherever
# the tree is moved. Where stein is a static library, what it is linked to comes with it, the C++ runtime for C programs included.
set(stein_pc_requires)
set(stein_exr_pc_requires)
set(stein_pc_libs)
if(stein_library_type STREQUAL "STATIC_LIBRARY")
  set(stein_pc_requires "Requires: tbb libhwy")
  set(stein_exr_pc_requires ", OpenEXR, zlib")
  set(stein_runtime ${CMAKE_CXX_IMPLICIT_LINK_LIBRARIES})
  list(REMOVE_ITEM stein_runtime gcc gcc_s c)
  list(REMOVE_DUPLICATES stein_runtime)
  list(TRANSFORM stein_runtime PREPEND -l)
  list(JOIN stein_runtime " " stein_runtime)
  set(stein_pc_libs "${stein_runtime} ${CMAKE_THREAD_LIBS_INIT}")
endif()
file(RELATIVE_PATH stein_pc_prefix ${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" stein_pc_prefix "${stein_pc_prefix}")
foreach(name ${stein_installed_targets})
  configure_file(${PROJECT_SOURCE_DIR}/cmake/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endforeach()
