# An overlay port of the sources around it:
#   vcpkg install tactoid --overlay-ports=<tactoid>/cmake/vcpkg
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(VCPKG_BUILD_TYPE release) # headers only
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    -DTACTOID_BUILD_TESTS=OFF
    -DTACTOID_BUILD_EXAMPLES=OFF
    -DTACTOID_BUILD_BENCHMARKS=OFF
    -DTACTOID_FETCH=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME tactoid CONFIG_PATH share/cmake/tactoid)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/share/doc")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
