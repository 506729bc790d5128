# Installs in components: program (wheeltap, its MPI module, completions and manual page), dev (libraries, headers, the package
# for find_package(wheeltap)) python (python/CMakeLists.txt) and, with WHEELTAP_WITH_MANUAL, manual
# (docs/CMakeLists.txt). `uninstall` takes all of them away.
include(CMakePackageConfigHelpers)
set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/wheeltap")

if(TARGET wheeltap)
  install(TARGETS wheeltap RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
endif()
if(TARGET wheeltap_mpi AND TARGET wheeltap)
  install(TARGETS wheeltap_mpi LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/wheeltap COMPONENT program)
endif()

if(TARGET wheeltap_texts)
  set(texts "${PROJECT_BINARY_DIR}/apps/texts")
  install(FILES "${texts}/wheeltap" DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
  install(FILES "${texts}/_wheeltap" DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
  install(FILES "${texts}/wheeltap.fish" DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
  install(FILES "${texts}/wheeltap.1" DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
endif()

# Each library is exported by itself, so that a program needs what its own libraries need and no more.
# apps is the program's inside, and has no headers for others.
get_property(libraries GLOBAL PROPERTY WHEELTAP_LIBRARIES)
list(REMOVE_ITEM libraries wheeltap_apps)
set(WHEELTAP_BUILT "")
set(WHEELTAP_NEEDS "")
foreach(library IN LISTS libraries)
  get_target_property(name ${library} EXPORT_NAME)
  list(APPEND WHEELTAP_BUILT ${name})
  install(TARGETS ${library} EXPORT wheeltap_${name}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
  install(EXPORT wheeltap_${name} NAMESPACE wheeltap:: DESTINATION ${package_folder} COMPONENT dev)
  # What it links, ours and others'.
  get_target_property(links ${library} INTERFACE_LINK_LIBRARIES)
  string(REGEX MATCHALL "wheeltap::[a-z_]+" ours "${links}")
  string(REGEX MATCHALL "(Threads|Eigen3|PkgConfig|CGAL)::[A-Za-z]+" others "${links}")
  string(REPLACE "wheeltap::" "" ours "${ours}")
  list(REMOVE_DUPLICATES ours)
  list(REMOVE_DUPLICATES others)
  string(APPEND WHEELTAP_NEEDS
    "set(_wheeltap_${name}_libraries ${ours})\nset(_wheeltap_${name}_packages ${others})\n")
endforeach()
string(REPLACE ";" " " WHEELTAP_NEEDS "${WHEELTAP_NEEDS}")
string(REPLACE ";" " " WHEELTAP_BUILT "${WHEELTAP_BUILT}")

wheeltap_rooms(rooms)
list(REMOVE_ITEM rooms apps)
foreach(folder IN LISTS rooms)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/wheeltap COMPONENT dev
    FILES_MATCHING PATTERN "*.hpp")
endforeach()
configure_package_config_file(cmake/wheeltapConfig.cmake.in
  "${PROJECT_BINARY_DIR}/wheeltapConfig.cmake" INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file("${PROJECT_BINARY_DIR}/wheeltapConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/wheeltapConfig.cmake"
  "${PROJECT_BINARY_DIR}/wheeltapConfigVersion.cmake"
  DESTINATION ${package_folder} COMPONENT dev)

if(PROJECT_IS_TOP_LEVEL)
  add_custom_target(uninstall
    COMMAND ${CMAKE_COMMAND} -DBUILD=${PROJECT_BINARY_DIR} -P ${PROJECT_SOURCE_DIR}/cmake/uninstall.cmake)
endif()
