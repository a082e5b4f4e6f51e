# vcpkg itself was not run; docs/install.md says which steps were. SOURCE_PATH is the project
# that this port lies in, so that no archive has to be published:
#     vcpkg install hshfit[brdfs] --overlay-ports=packaging/vcpkg
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)

set(parts math)
if("files" IN_LIST FEATURES)
  set(parts files)
endif()
if("brdfs" IN_LIST FEATURES)
  set(parts brdfs)
endif()
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS -DHSHFIT_PARTS=${parts} -DHSHFIT_TESTS=OFF -DHSHFIT_EXAMPLES=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/hshfit)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
