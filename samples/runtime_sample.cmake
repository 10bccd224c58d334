# Samples of the runtime alone: linked like a game, run on the human that the baker makes, and on a file that is not there.
if(SPHERECHAIN_BAKER)
  set(sample_asset ${CMAKE_CURRENT_BINARY_DIR}/human.sphc)
  set(sample_source /usr/share/assimp/models/Collada/human.zae)  # Debian: assimp-testmodels
  add_test(NAME sample.bake_human COMMAND spherechain bake ${sample_source} -o ${sample_asset} --force)
  set_tests_properties(sample.bake_human PROPERTIES FIXTURES_SETUP sample_asset TIMEOUT 600)
else()
  message(STATUS "The runtime's samples run on no asset: SPHERECHAIN_BAKER is off, and assets are baked")
endif()

# A test that the program exits with `code` and prints `expected`, a regular expression.
function(sample_test name code expected)
  add_test(NAME sample.${name} COMMAND ${CMAKE_COMMAND} -D CODE=${code} -D EXPECTED=${expected}
    -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/run_sample.cmake -- ${ARGN})
endfunction()

# runtime_sample(NAME SOURCE EXPECTED [argument after the asset ...])
function(runtime_sample name source expected)
  set(target sample_${name})
  add_executable(${target} ${source})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name})
  if(source MATCHES "\\.c$")
    set_target_properties(${target} PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF)
    target_compile_options(${target} PRIVATE
      -Wall -Wextra -Wconversion -Wpedantic $<$<BOOL:${SPHERECHAIN_WERROR}>:-Werror>)
    target_link_libraries(${target} PRIVATE spherechain::runtime m)
  else()
    spherechain_target(${target} 17)
    target_link_libraries(${target} PRIVATE sample_skeleton)
  endif()
  sample_test(${name}.bad_path 3 "${name}: error: nowhere.sphc: cannot be read" $<TARGET_FILE:${target}> nowhere.sphc ${ARGN})
  if(SPHERECHAIN_BAKER)
    sample_test(${name} 0 ${expected} $<TARGET_FILE:${target}> ${sample_asset} ${ARGN})
    set_tests_properties(sample.${name} PROPERTIES FIXTURES_REQUIRED sample_asset)
  endif()
endfunction()
