# SPDX-License-Identifier: Apache-2.0
# What every target of the project has in common: language level, warnings, sanitizers.

# For code whose compile time counts, not its speed; with sanitizers, optimising takes longer than all it saves.
if(STEIN_SANITIZE)
  set(STEIN_TEXT_OPTIMISATION -O0)
else()
  set(STEIN_TEXT_OPTIMISATION -O1)
endif()

# stein_uninstrumented(NAME): code of tests that sanitizers would look at in vain; it links to what they do look at.
function(stein_uninstrumented name)
  if(STEIN_SANITIZE)
    target_compile_options(${name} PRIVATE -fno-sanitize=all)
    set_target_properties(${name} PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)  # theirs are instrumented
  endif()
endfunction()

function(stein_target name)
  target_compile_features(${name} PUBLIC cxx_std_20)
  set_target_properties(${name} PROPERTIES
    CXX_EXTENSIONS OFF CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wpedantic -Wconversion -Wshadow $<$<BOOL:${STEIN_WERROR}>:-Werror>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${name} PRIVATE -Wno-restrict)  # false alarms in std::string (GCC bug 105651)
  endif()
  if(STEIN_SANITIZE)
    target_compile_options(${name} PUBLIC -fsanitize=${STEIN_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    # A third of the compile time, for what faults by itself or AddressSanitizer finds as well.
    target_compile_options(${name} PUBLIC -fno-sanitize=null,object-size,vptr)
    target_link_options(${name} PUBLIC -fsanitize=${STEIN_SANITIZE})
  endif()
endfunction()

# stein_library(name): a library of the interface. Where it is shared, its symbols are versioned, and only what a header in
# include/ declares shows; cmake/stein.map.in says which names that are. Where it is static, it can become part of plug-ins.
function(stein_library name)
  stein_target(${name})
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON DEFINE_SYMBOL ""
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  get_target_property(type ${name} TYPE)
  if(type STREQUAL "SHARED_LIBRARY")
    configure_file(${PROJECT_SOURCE_DIR}/cmake/stein.map.in ${PROJECT_BINARY_DIR}/stein.map @ONLY)
    target_link_options(${name} PRIVATE LINKER:--version-script=${PROJECT_BINARY_DIR}/stein.map)
    set_target_properties(${name} PROPERTIES LINK_DEPENDS ${PROJECT_BINARY_DIR}/stein.map)
  endif()
endfunction()
