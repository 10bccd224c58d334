# Installs the library that a game with crowds on the GPU also links: `cmake --install <build> --component cuda`.
# spherechainConfig.cmake (runtime/) finds it there.
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/spherechain)
install(TARGETS spherechain_cuda EXPORT spherechain_cuda ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT cuda)
install(DIRECTORY include/spherechain DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT cuda)
install(EXPORT spherechain_cuda NAMESPACE spherechain:: FILE spherechainCudaTargets.cmake DESTINATION ${package} COMPONENT cuda)

# pkg-config: the archive wants the toolkit's archive, wherever that was when this was built.
set(pc_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH pc_prefix /${pc_folder} /)
string(REGEX REPLACE "/$" "" pc_prefix "${pc_prefix}")
configure_file(spherechain-cuda.pc.in spherechain-cuda.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/spherechain-cuda.pc DESTINATION ${pc_folder} COMPONENT cuda)
