# Installs the files that a game links, and nothing of the baker: `cmake --install <build> --component sdk`. In a
# shared build the components runtime and dev are the same in two parts, for Debian's packages: what programs run with, and
# what they are built with. Not with CUDA: its targets may refer to one export of the runtime alone.
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/spherechain)

install(TARGETS spherechain_runtime EXPORT spherechain
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT sdk
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT sdk
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT sdk)
get_target_property(type spherechain_runtime TYPE)
set(components sdk)
if(type STREQUAL SHARED_LIBRARY AND NOT SPHERECHAIN_CUDA_FOUND)
  list(APPEND components dev)
  install(TARGETS spherechain_runtime
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev EXCLUDE_FROM_ALL
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT dev EXCLUDE_FROM_ALL
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime EXCLUDE_FROM_ALL)
endif()

configure_file(spherechainConfig.cmake.in spherechainConfig.cmake COPYONLY)
# Before 1.0 a minor version may break what the one before it had.
write_basic_package_version_file(spherechainConfigVersion.cmake COMPATIBILITY SameMinorVersion)

# pkg-config: paths from the file's own place, so that the prefix may be moved.
set(pc_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH pc_prefix /${pc_folder} /)
string(REGEX REPLACE "/$" "" pc_prefix "${pc_prefix}")
set(pc_definitions)
if(type STREQUAL SHARED_LIBRARY)
  set(pc_definitions " -DSPHERECHAIN_SHARED")
endif()
configure_file(spherechain.pc.in spherechain.pc @ONLY)

foreach(component IN LISTS components)
  set(once)
  if(component STREQUAL "dev")
    set(once EXCLUDE_FROM_ALL)
  endif()
  install(DIRECTORY include/spherechain ${CMAKE_CURRENT_BINARY_DIR}/include/spherechain
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${component} ${once})
  install(EXPORT spherechain NAMESPACE spherechain:: FILE spherechainTargets.cmake DESTINATION ${package}
    COMPONENT ${component} ${once})
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/spherechainConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/spherechainConfigVersion.cmake
    DESTINATION ${package} COMPONENT ${component} ${once})
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/spherechain.pc DESTINATION ${pc_folder} COMPONENT ${component} ${once})
endforeach()
# The samples, as a project of their own: samples/README.md. In archives alone.
foreach(sample gltf_pose hello c_api load_and_refit crowd stop_at_contact duel)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/samples/${sample} DESTINATION samples COMPONENT samples EXCLUDE_FROM_ALL
    PATTERN CMakeLists.txt EXCLUDE PATTERN check_quote.cmake EXCLUDE)
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/samples/sdk/CMakeLists.txt DESTINATION samples COMPONENT samples EXCLUDE_FROM_ALL)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT sdk)
install(FILES copyright DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT sdk)
# Debian wants one in each package's own folder.
install(FILES copyright DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/libspherechain COMPONENT runtime EXCLUDE_FROM_ALL)
install(FILES copyright DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/libspherechain-dev COMPONENT dev EXCLUDE_FROM_ALL)
