# One static library a folder, one warning policy for all of them, no global flags.
include(GNUInstallDirs)

# The flags that every target of ours shares. Private: users of the libraries do not inherit them.
add_library(wheeltap_flags INTERFACE)
# GCC 12 sees overlapping copies where a literal and std::to_string are added (GCC bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(wheeltap_flags INTERFACE -Wno-restrict)
endif()
# GCC tidies its memory from 128 MB on, which takes a tenth of its time. With 4 GB for each core it need not.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  cmake_host_system_information(RESULT memory QUERY TOTAL_PHYSICAL_MEMORY)  # MiB
  cmake_host_system_information(RESULT cores QUERY NUMBER_OF_LOGICAL_CORES)
  math(EXPR memory_per_core "${memory} / ${cores}")
  if(memory_per_core GREATER_EQUAL 4096)
    target_compile_options(wheeltap_flags INTERFACE --param=ggc-min-heapsize=2000000)
  endif()
endif()
# Under CMAKE_UNITY_BUILD sources are included, and GCC takes them for headers, whose types must not hold types of an
# anonymous namespace. The `dev` preset, which has no unity, checks the headers.
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(wheeltap_flags INTERFACE -Wno-subobject-linkage)
endif()
# Warnings take a twelfth of the compile time and help only those who change the code: the `dev` preset and .ci/run.
if(WHEELTAP_WARNINGS_AS_ERRORS)
  target_compile_options(wheeltap_flags INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wpedantic -Werror)
endif()
if(WHEELTAP_NATIVE)
  target_compile_options(wheeltap_flags INTERFACE -march=native)
endif()
if(WHEELTAP_SANITIZE)
  target_compile_options(wheeltap_flags INTERFACE
    -fsanitize=${WHEELTAP_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(wheeltap_flags INTERFACE -fsanitize=${WHEELTAP_SANITIZE})
  # The short run of CI spends its time on compilation: -O0 compiles in half the time of the presets' -O1.
  if(WHEELTAP_SANITIZE_SHORT)
    target_compile_options(wheeltap_flags INTERFACE -O0)
  endif()
endif()

# The folders that WHEELTAP_COMPONENTS asks for, with what they stand on, in the order of building.
function(wheeltap_rooms out)
  set(house base io signals fem dynamics emulator inference identification)
  set(stands_on_io base)
  set(stands_on_signals io)
  set(stands_on_fem base)
  set(stands_on_dynamics signals)
  set(stands_on_emulator io)
  set(stands_on_inference base)
  set(stands_on_identification fem dynamics emulator inference)
  if(NOT WHEELTAP_COMPONENTS)
    set(${out} ${house} apps PARENT_SCOPE)
    return()
  endif()
  set(open ${WHEELTAP_COMPONENTS})
  set(wanted "")
  while(open)
    list(POP_FRONT open room)
    if(NOT room IN_LIST house)
      string(REPLACE ";" ", " names "${house}")
      message(FATAL_ERROR "WHEELTAP_COMPONENTS: there is no \"${room}\"; there are ${names}")
    endif()
    list(APPEND wanted ${room})
    list(APPEND open ${stands_on_${room}})
  endwhile()
  set(rooms "")
  foreach(room IN LISTS house)
    if(room IN_LIST wanted)
      list(APPEND rooms ${room})
    endif()
  endforeach()
  set(${out} ${rooms} PARENT_SCOPE)
endfunction()

# wheeltap_unity(<target> SIZE <files> ALONE <file>… TOGETHER "<folder> <folder>"…): under CMAKE_UNITY_BUILD (presets of users and of
# CI, not `dev`) several files are compiled as one, in less than half the time. Each argument of TOGETHER names folders
# whose files form one group: files with the same includes share their templates ("." are files without a folder).
# Other files are distributed over groups of fewer than SIZE files by a hash of their names, so that a new file leaves
# the others where they were.
# The files of ALONE, whose own names clash with those of others, are compiled alone.
function(wheeltap_unity target)
  cmake_parse_arguments(ARG "" "SIZE" "ALONE;TOGETHER" ${ARGN})
  set(together 0)
  foreach(folders IN LISTS ARG_TOGETHER)
    string(REPLACE " " ";" folders "${folders}")
    foreach(folder IN LISTS folders)
      set("group_of_${folder}" "folders_${together}")
    endforeach()
    math(EXPR together "${together} + 1")
  endforeach()
  get_target_property(sources ${target} SOURCES)
  list(LENGTH sources count)
  set(groups 1)
  while(groups LESS_EQUAL 32 AND NOT count LESS ${ARG_SIZE})
    math(EXPR groups "2 * ${groups}")
    math(EXPR count "${count} / 2")
  endwhile()
  foreach(source IN LISTS sources)
    set(folder ".")
    if(source MATCHES "^([^/]+)/")
      set(folder "${CMAKE_MATCH_1}")
    endif()
    if(DEFINED "group_of_${folder}")
      set(group "${group_of_${folder}}")
    else()
      get_filename_component(name "${source}" NAME)
      string(MD5 drawn "${name}")
      string(SUBSTRING "${drawn}" 0 6 drawn)
      math(EXPR group "0x${drawn} % ${groups}")
    endif()
    set_source_files_properties("${source}" PROPERTIES UNITY_GROUP ${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  set_source_files_properties(${ARG_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# wheeltap_library(<folder> SOURCES a.cpp … ALONE a.cpp … TOGETHER "folder …" … PUBLIC dep … PRIVATE dep …)
# makes the static library wheeltap_<folder>, known as wheeltap::<folder>; headers alone without SOURCES.
function(wheeltap_library folder)
  cmake_parse_arguments(ARG "" "" "SOURCES;ALONE;TOGETHER;PUBLIC;PRIVATE" ${ARGN})
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
  wheeltap_unity(${target} SIZE 100 ALONE ${ARG_ALONE} TOGETHER ${ARG_TOGETHER})
endfunction()

# wheeltap_kernels(<target> <stem> [ONE_SANITIZED] [PLAIN]): <stem>_baseline.cpp and, on x86, <stem>_avx2.cpp and <stem>_avx512.cpp,
# one source for registers of each width; which one runs is chosen then (base/simd.hpp). Never contracted to fused
# multiply-add, so that all of them give the same bits and a run does not depend on the processor. ONE_SANITIZED: the
# sanitizers' builds have the baseline alone. PLAIN: see wheeltap_plain.
function(wheeltap_kernels target stem)
  cmake_parse_arguments(ARG "ONE_SANITIZED;PLAIN" "" "" ${ARGN})
  set(kernels ${stem}_baseline.cpp)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT (ARG_ONE_SANITIZED AND WHEELTAP_SANITIZE))
    list(APPEND kernels ${stem}_avx2.cpp ${stem}_avx512.cpp)
    set_property(SOURCE ${stem}_avx2.cpp APPEND PROPERTY COMPILE_OPTIONS -mavx2)
    set_property(SOURCE ${stem}_avx512.cpp APPEND PROPERTY COMPILE_OPTIONS
      -mavx512f -mavx512dq -mavx512vl -mprefer-vector-width=512)
    target_compile_definitions(${target} PRIVATE WHEELTAP_X86_KERNELS)
  endif()
  set_property(SOURCE ${kernels} APPEND PROPERTY COMPILE_OPTIONS
    -ffp-contract=off -fno-trapping-math -fno-math-errno)
  if(ARG_PLAIN)
    set_property(SOURCE ${kernels} APPEND PROPERTY COMPILE_OPTIONS "$<$<CONFIG:Release>:-O2>")
  else()
    set_property(SOURCE ${kernels} APPEND PROPERTY COMPILE_OPTIONS "$<$<CONFIG:Release>:-O3>")
  endif()
  # GCC 12 ends with an internal error otherwise (gimple_expand_vec_cond_expr) under the sanitizer of threads, and that of
  # addresses without undefined behaviour's.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND WHEELTAP_SANITIZE)
    set_property(SOURCE ${kernels} APPEND PROPERTY COMPILE_OPTIONS -fno-tree-forwprop)
  endif()
  target_sources(${target} PRIVATE ${kernels})
endfunction()

# wheeltap_light(<target>): -O1, for code whose running time is in the libraries that it calls. It compiles in two thirds
# of the time of a release's -O3.
function(wheeltap_light target)
  target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:-O1>")
endfunction()

# wheeltap_lightest(<target>): -Og, for code that moves text. It compiles in three quarters of the time of -O1.
function(wheeltap_lightest target)
  target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:-Og>")
endfunction()

# wheeltap_plain(<target>): -O2. The loops that take the running time are in kernels (wheeltap_kernels, -O3) and in the
# products and decompositions of base; the other code compiles in five sixths of the time of -O3.
function(wheeltap_plain target)
  target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:-O2>")
endfunction()

# wheeltap_program(<name> SOURCES … ALONE … LINK …): an executable with the shared flags.
function(wheeltap_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;ALONE;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_link_libraries(${name} PRIVATE ${ARG_LINK} wheeltap_flags)
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
  wheeltap_unity(${name} SIZE 40 ALONE ${ARG_ALONE})
endfunction()
