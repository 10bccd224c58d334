# Samples of the runtime: linked like a game, run headless. Their characters:
# - human.zae has no rig. The bake gives it the automatic one, and its preview is a glTF file with those joints; pose_clip
#   adds a clip to it. `automatic` is the asset of human.zae.
# - That glTF file has bones of its own, like any game's. `own_bones` is the asset of it.
# - CesiumMan.glb of the folder that SPHERECHAIN_TEST_DATA names, where it is set.
find_package(TinyGLTF CONFIG QUIET)  # Debian: libtinygltf-dev
find_package(nlohmann_json CONFIG QUIET)
if(NOT TinyGLTF_FOUND)
  message(STATUS "TinyGLTF is not there: no samples, they read glTF files")
endif()
set(sample_human /usr/share/assimp/models/Collada/human.zae)  # Debian: assimp-testmodels
set(sample_automatic ${CMAKE_CURRENT_BINARY_DIR}/automatic.sphc)
set(sample_preview ${CMAKE_CURRENT_BINARY_DIR}/preview.glb)
set(sample_model ${CMAKE_CURRENT_BINARY_DIR}/human.glb)
set(sample_own_bones ${CMAKE_CURRENT_BINARY_DIR}/own_bones.sphc)

# Bakes the samples' assets once, before all samples.
function(sample_fixtures)
  add_test(NAME sample.bake_automatic COMMAND spherechain bake ${sample_human} -o ${sample_automatic} --preview ${sample_preview} --force)
  add_test(NAME sample.pose_clip COMMAND pose_clip ${sample_preview} ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/poses/animation_arms.json ${sample_model})
  add_test(NAME sample.bake_own_bones COMMAND spherechain bake ${sample_model} -o ${sample_own_bones} --force)
  set_tests_properties(sample.bake_automatic PROPERTIES FIXTURES_SETUP sample_preview TIMEOUT 600)
  set_tests_properties(sample.pose_clip PROPERTIES FIXTURES_REQUIRED sample_preview FIXTURES_SETUP sample_model)
  set_tests_properties(sample.bake_own_bones PROPERTIES
    FIXTURES_REQUIRED sample_model FIXTURES_SETUP sample_assets TIMEOUT 600)
endfunction()
if(SPHERECHAIN_BAKER AND TinyGLTF_FOUND)
  sample_fixtures()
endif()

# A test that the program exits with `code` and prints `expected`, a regular expression.
function(sample_test name code expected)
  add_test(NAME sample.${name} COMMAND ${CMAKE_COMMAND} -D CODE=${code} -D EXPECTED=${expected}
    -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/run_sample.cmake -- ${ARGN})
endfunction()

# runtime_sample(NAME SOURCE EXPECTED [own_bones_only])
function(runtime_sample name source expected)
  set(target sample_${name})
  add_executable(${target} ${source})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name})
  target_link_libraries(${target} PRIVATE sample_gltf_pose)
  if(source MATCHES "\\.c$")
    set_target_properties(${target} PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF)
    if(NOT MSVC)
      target_compile_options(${target} PRIVATE
        -Wall -Wextra -Wconversion -Wpedantic $<$<BOOL:${SPHERECHAIN_WERROR}>:-Werror>)
    endif()
  else()
    spherechain_target(${target} 17)
  endif()
  sample_test(${name}.bad_path 3 "${name}: error: nowhere.sphc: cannot be read" $<TARGET_FILE:${target}> nowhere.sphc nowhere.glb)
  if(NOT SPHERECHAIN_BAKER)
    return()
  endif()
  set(assets automatic own_bones)
  if("own_bones_only" IN_LIST ARGN)
    set(assets own_bones)
  endif()
  foreach(asset ${assets})
    sample_test(${name}.${asset} 0 ${expected} $<TARGET_FILE:${target}> ${sample_${asset}} ${sample_model})
    set_tests_properties(sample.${name}.${asset} PROPERTIES FIXTURES_REQUIRED "sample_preview;sample_model;sample_assets")
  endforeach()
  add_test(NAME sample.${name}.test_data COMMAND ${CMAKE_COMMAND} -D TOOL=$<TARGET_FILE:spherechain>
    -D SAMPLE=$<TARGET_FILE:${target}> -D ASSET=${CMAKE_CURRENT_BINARY_DIR}/cesium_man.sphc
    -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/run_test_data.cmake)
  set_tests_properties(sample.${name}.test_data PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped: " TIMEOUT 300)
endfunction()
