# Debian packages of what is installed, one a component: `cpack -G DEB --config build/release/CPackConfig.cmake`.
# Their dependencies are read off the programs by dpkg-shlibdeps.
set(CPACK_PACKAGE_NAME wheeltap)
set(CPACK_PACKAGE_VENDOR Wheeltap)
set(CPACK_PACKAGE_CONTACT "Wheeltap <nobody@wheeltap.invalid>")
# Each package has a description of its own, synopsis first.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(about "Wheeltap infers from measured vibration the number, location and severity of
damages of a structure, since when a monitored structure has changed, and the
equation of motion of a test rig, with calibrated probabilities.")
# Read by packaging/debian/documents.cmake.
set(CPACK_WHEELTAP_SOURCE "${PROJECT_SOURCE_DIR}")
set(CPACK_PRE_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/packaging/debian/documents.cmake")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL dev)
if(TARGET wheeltap)
  list(APPEND CPACK_COMPONENTS_ALL program)
endif()
if(TARGET wheeltap_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
if(WHEELTAP_WITH_MANUAL)
  list(APPEND CPACK_COMPONENTS_ALL manual)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "structural health monitoring with calibrated probabilities
${about}
.
This package has the program, its manual page and completions for shells.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME wheeltap)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# Loaded by mpirun -n N wheeltap alone.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS openmpi-bin)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libwheeltap-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_DESCRIPTION "structural health monitoring - C++ libraries
${about}
.
This package has the static libraries, their headers, and what
the files for CMake's find_package.")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libeigen3-dev, librandom123-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "pkg-config, libnetcdf-dev, libsuitesparse-dev, libmatio-dev, zlib1g-dev, libexpat1-dev, libcgal-dev")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-wheeltap)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
# For the one interpreter that it was built for.
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3-numpy")
if(TARGET wheeltap_python)
  math(EXPR next "${WHEELTAP_PYTHON_MINOR} + 1")
  string(PREPEND CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${WHEELTAP_PYTHON_MINOR}), python3 (<< 3.${next}), ")
endif()
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "structural health monitoring - Python package
${about}
.
This package has `import wheeltap`: runs, records, modes, figures, and
user-defined likelihoods for the sampler.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  "${PROJECT_SOURCE_DIR}/packaging/debian/postinst;${PROJECT_SOURCE_DIR}/packaging/debian/prerm")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-matplotlib, python3-xarray, python3-netcdf4")
set(CPACK_DEBIAN_MANUAL_PACKAGE_NAME wheeltap-doc)
set(CPACK_DEBIAN_MANUAL_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_MANUAL_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_MANUAL_DESCRIPTION "structural health monitoring - manual
${about}
.
This package has the manual as a site that needs no network: guide, tutorials,
theory, validation, reports, and the reference of the C++ and Python libraries.")
include(CPack)
