# SPDX-License-Identifier: MIT
# cmake -D CASE=... -P javascript_test.cmake
#   golden       hashes of spheres, pairs, contacts and penetrations are those of tests/golden
#   api          the package beside the C interface, and what it refuses
#   which_parts  the sample prints the lines of samples/hello
#   page         the programs of docs/javascript.md, word for word, in Node and Chromium
#   chromium     the sample's page; contacts of a human in under half a millisecond; the package in a page from disk
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
set(here ${ROOT}/tests/javascript)

function(run output)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${WORK} RESULT_VARIABLE result OUTPUT_VARIABLE text ERROR_VARIABLE error)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "exit ${result}: ${ARGN}\n${text}${error}")
  endif()
  set(${output} "${text}" PARENT_SCOPE)
endfunction()

if(CASE MATCHES "page|chromium" AND NOT CHROMIUM)
  message("SKIPPED: chromium is missing (Debian: chromium)")
  return()
endif()
if(CASE MATCHES "api|which_parts|chromium")
  run(nothing ${WRITE_PALETTES} ${MODEL} human.palettes)
endif()
if(CASE MATCHES "which_parts|page|chromium")  # as npm installs it
  file(MAKE_DIRECTORY ${WORK}/node_modules)
  file(CREATE_LINK ${PACKAGE} ${WORK}/node_modules/spherechain SYMBOLIC)
endif()

if(CASE STREQUAL golden)
  run(nothing ${WRITE_CLIP} ${ROOT}/tests/golden doll.clip)
  run(text ${NODE} ${here}/golden.mjs ${PACKAGE} ${ROOT}/tests/golden doll.clip)
  message(STATUS "${text}")
elseif(CASE STREQUAL api)
  run(text ${REFERENCE} ${OWN_BONES} human.palettes)
  file(WRITE ${WORK}/native.txt "${text}")
  run(text ${NODE} --test-reporter=spec ${here}/api.mjs ${PACKAGE} ${OWN_BONES} human.palettes native.txt)
  message(STATUS "${text}")
elseif(CASE STREQUAL which_parts)
  file(GLOB sample ${ROOT}/samples/javascript/*.mjs)
  file(COPY ${sample} DESTINATION ${WORK})
  run(expected ${HELLO} ${OWN_BONES} ${MODEL})
  run(text ${NODE} which_parts.mjs ${OWN_BONES} human.palettes)
  if(NOT text STREQUAL expected OR NOT text MATCHES "left hand in head, [1-9]")
    message(FATAL_ERROR "which_parts.mjs prints:\n${text}\nhello prints:\n${expected}")
  endif()
  execute_process(COMMAND ${NODE} which_parts.mjs ${ROOT}/LICENSE human.palettes WORKING_DIRECTORY ${WORK} RESULT_VARIABLE result ERROR_VARIABLE error)
  if(NOT result EQUAL 3 OR NOT error MATCHES "^which_parts: error: ")
    message(FATAL_ERROR "of a file that is no asset: exit ${result}, \"${error}\"")
  endif()
else()
  message(FATAL_ERROR "no such case: ${CASE}")
endif()
