# Makes PAGE, and the report's pages beside it, of the sources in SOURCE, in FOLDER, with the RUNTIME's JavaScript where that is given; makes none, and is content, where npm's packages cannot be had.
include(${CMAKE_CURRENT_LIST_DIR}/npm_ci.cmake)
npm_ci(${SOURCE} ${FOLDER} "The page of `spherechain view`" installed)
file(REMOVE ${PAGE})  # one of other sources would show nonsense
if(NOT installed)
  return()
endif()
file(REMOVE_RECURSE ${FOLDER}/src)
file(COPY ${SOURCE}/src ${SOURCE}/index.html ${SOURCE}/library.html ${SOURCE}/score.html ${SOURCE}/build.mjs DESTINATION ${FOLDER})
get_filename_component(pages ${PAGE} DIRECTORY)
execute_process(COMMAND ${NODE} ${FOLDER}/build.mjs ${pages} ${RUNTIME} COMMAND_ERROR_IS_FATAL ANY)
