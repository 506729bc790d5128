# An overlay port of what stands on Eigen and Random123 alone: the engine (wheeltap::inference) and wheeltap::base. The
# other libraries want packages that vcpkg has under other names or not at all. Random123's headers are looked for as
# everywhere. OWNER and SHA512 are to be filled in at a release; not built yet.
vcpkg_from_github(OUT_SOURCE_PATH SOURCE_PATH REPO OWNER/wheeltap REF "v${VERSION}" SHA512 0)
vcpkg_cmake_configure(SOURCE_PATH "${SOURCE_PATH}" OPTIONS
  -DWHEELTAP_COMPONENTS=inference -DWHEELTAP_TESTS=OFF -DWHEELTAP_BENCH=OFF -DWHEELTAP_EXAMPLES=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/wheeltap)
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
