# One static library a folder, one warning policy for all of them, no global flags.
include(GNUInstallDirs)

# The flags that every target of ours shares. Private: users of the libraries do not inherit them.
add_library(wheeltap_flags INTERFACE)
target_compile_options(wheeltap_flags INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wpedantic)
# GCC 12 sees overlapping copies where a literal and std::to_string are added (GCC bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(wheeltap_flags INTERFACE -Wno-restrict)
endif()
if(WHEELTAP_WARNINGS_AS_ERRORS)
  target_compile_options(wheeltap_flags INTERFACE -Werror)
endif()
if(WHEELTAP_NATIVE)
  target_compile_options(wheeltap_flags INTERFACE -march=native)
endif()
if(WHEELTAP_SANITIZE)
  target_compile_options(wheeltap_flags INTERFACE
    -fsanitize=${WHEELTAP_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(wheeltap_flags INTERFACE -fsanitize=${WHEELTAP_SANITIZE})
endif()

# wheeltap_library(<folder> SOURCES a.cpp … PUBLIC dep … PRIVATE dep …)
# makes the static library wheeltap_<folder>, known as wheeltap::<folder>; headers alone without SOURCES.
function(wheeltap_library folder)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target wheeltap_${folder})
  set_property(GLOBAL APPEND PROPERTY WHEELTAP_LIBRARIES ${target})
  if(NOT ARG_SOURCES)
    add_library(${target} INTERFACE)
    add_library(wheeltap::${folder} ALIAS ${target})
    target_compile_features(${target} INTERFACE cxx_std_20)
    target_include_directories(${target} INTERFACE
      $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/wheeltap>)
    target_link_libraries(${target} INTERFACE ${ARG_PUBLIC})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${folder})
    return()
  endif()
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(wheeltap::${folder} ALIAS ${target})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/wheeltap>)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:wheeltap_flags>)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${folder} CXX_EXTENSIONS OFF
    POSITION_INDEPENDENT_CODE ON)
endfunction()

# wheeltap_program(<name> SOURCES … LINK …): an executable with the shared flags.
function(wheeltap_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_link_libraries(${name} PRIVATE ${ARG_LINK} wheeltap_flags)
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
endfunction()
