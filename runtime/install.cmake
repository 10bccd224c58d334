# What a game links: `cmake --install <build> --component sdk` installs this and nothing of the baker.
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/spherechain)

install(TARGETS spherechain_runtime EXPORT spherechain
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT sdk
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT sdk
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT sdk)
install(DIRECTORY include/spherechain DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT sdk)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT sdk)
install(EXPORT spherechain NAMESPACE spherechain:: FILE spherechainTargets.cmake DESTINATION ${package} COMPONENT sdk)
configure_file(spherechainConfig.cmake.in spherechainConfig.cmake COPYONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/spherechainConfig.cmake DESTINATION ${package} COMPONENT sdk)

# Before 1.0 a minor version may break what the one before it had.
write_basic_package_version_file(spherechainConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/spherechainConfigVersion.cmake DESTINATION ${package} COMPONENT sdk)

# pkg-config: paths from the file's own place, so that the prefix may be moved.
set(pc_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH pc_prefix /${pc_folder} /)
string(REGEX REPLACE "/$" "" pc_prefix "${pc_prefix}")
get_target_property(type spherechain_runtime TYPE)
set(pc_definitions)
if(type STREQUAL SHARED_LIBRARY)
  set(pc_definitions " -DSPHERECHAIN_SHARED")
endif()
configure_file(spherechain.pc.in spherechain.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/spherechain.pc DESTINATION ${pc_folder} COMPONENT sdk)
