# SPDX-License-Identifier: MIT
# cmake -D TOOL=<spherechain> -D SAMPLE=<program> -D ASSET=<out> -P run_test_data.cmake: bakes a character with bones of its
# own, of the folder that SPHERECHAIN_TEST_DATA names, and runs the sample on it.
if("$ENV{SPHERECHAIN_TEST_DATA}" STREQUAL "")
  message("skipped: SPHERECHAIN_TEST_DATA names no folder of characters")
  return()
endif()
set(model "$ENV{SPHERECHAIN_TEST_DATA}/CesiumMan.glb")
execute_process(COMMAND ${TOOL} bake ${model} -o ${ASSET} --force COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${SAMPLE} ${ASSET} ${model} COMMAND_ERROR_IS_FATAL ANY)
