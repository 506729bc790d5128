# What Debian's policy wants beside the files that are installed: copyright, changelog and manual pages,
# these compressed. CPack runs it over each package's folder before it packs them.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(GLOB components LIST_DIRECTORIES true "${CPACK_TEMPORARY_DIRECTORY}/*")
foreach(component IN LISTS components)
  get_filename_component(name "${component}" NAME)
  string(TOUPPER "${name}" upper)
  set(package "${CPACK_DEBIAN_${upper}_PACKAGE_NAME}")
  if(NOT IS_DIRECTORY "${component}/usr" OR package STREQUAL "")
    continue()
  endif()
  set(documents "${component}/usr/share/doc/${package}")
  file(MAKE_DIRECTORY "${documents}")
  file(COPY_FILE "${CPACK_WHEELTAP_SOURCE}/packaging/debian/copyright" "${documents}/copyright")
  file(WRITE "${documents}/changelog"
    "${package} (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium\n\n"
    "  * What changed is told in CHANGELOG.md of the sources.\n\n"
    " -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  file(GLOB pages "${component}/usr/share/man/man1/*.1")
  execute_process(COMMAND gzip -9nf "${documents}/changelog" ${pages} COMMAND_ERROR_IS_FATAL ANY)
  file(CHMOD "${documents}/copyright" "${documents}/changelog.gz"
    PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
endforeach()
