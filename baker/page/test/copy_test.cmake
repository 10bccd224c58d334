# The test and its packages in FOLDER; without the packages, and content, where npm cannot have them: main.mjs says so.
include(${CMAKE_CURRENT_LIST_DIR}/../web/npm_ci.cmake)
npm_ci(${SOURCE} ${FOLDER} "The test viewer.page" installed)
file(GLOB sources ${SOURCE}/*.mjs)
file(COPY ${sources} DESTINATION ${FOLDER})
if(installed)
  file(TOUCH ${FOLDER}/sources.stamp)
endif()
