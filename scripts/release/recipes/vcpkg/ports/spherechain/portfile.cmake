# SPDX-License-Identifier: MIT
# Untested: no vcpkg has run this. Whoever publishes the port fills in OWNER/REPOSITORY and the SHA512 of the tag's archive.
vcpkg_from_github(
  OUT_SOURCE_PATH SOURCE_PATH
  REPO OWNER/REPOSITORY
  REF "v${VERSION}"
  SHA512 0
  HEAD_REF main
)

vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    -DSPHERECHAIN_BAKER=OFF
    -DSPHERECHAIN_TESTS=OFF
    -DSPHERECHAIN_STUDIES=OFF
    -DSPHERECHAIN_CUDA=OFF
    -DSPHERECHAIN_PYTHON=OFF
    -DSPHERECHAIN_JAVASCRIPT=OFF
    "-DSPHERECHAIN_FLATC=${CURRENT_HOST_INSTALLED_DIR}/tools/flatbuffers/flatc${VCPKG_HOST_EXECUTABLE_SUFFIX}"
    "-DSPHERECHAIN_FLATBUFFERS_INCLUDE_DIR=${CURRENT_INSTALLED_DIR}/include"
    "-DSPHERECHAIN_HIGHWAY_INCLUDE_DIR=${CURRENT_INSTALLED_DIR}/include"
)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/spherechain)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share" "${CURRENT_PACKAGES_DIR}/share/doc")
file(INSTALL "${CMAKE_CURRENT_LIST_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/runtime/LICENSE" "${SOURCE_PATH}/runtime/copyright")
