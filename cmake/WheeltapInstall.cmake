# Installs the program, the libraries and their headers, and the package files for find_package(wheeltap).
include(CMakePackageConfigHelpers)
get_property(libraries GLOBAL PROPERTY WHEELTAP_LIBRARIES)
install(TARGETS ${libraries} EXPORT wheeltapTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET wheeltap)
  install(TARGETS wheeltap RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
if(TARGET wheeltap_mpi)
  install(TARGETS wheeltap_mpi LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/wheeltap)
endif()
foreach(folder base io signals fem dynamics emulator inference identification)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/wheeltap
    FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(EXPORT wheeltapTargets NAMESPACE wheeltap:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/wheeltap)
configure_package_config_file(cmake/wheeltapConfig.cmake.in
  "${PROJECT_BINARY_DIR}/wheeltapConfig.cmake"
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/wheeltap)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/wheeltapConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/wheeltapConfig.cmake"
  "${PROJECT_BINARY_DIR}/wheeltapConfigVersion.cmake"
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/wheeltap)
