# SPDX-License-Identifier: MIT
# cmake -D ROOT=<repository> -P include_rules.cmake: fails on an include that runtime/ or cuda/ must not have.
file(GLOB_RECURSE sources ${ROOT}/runtime/*.h ${ROOT}/runtime/*.cpp ${ROOT}/runtime/*.cc ${ROOT}/runtime/*.inl
  ${ROOT}/cuda/*.h ${ROOT}/cuda/*.cuh ${ROOT}/cuda/*.cpp ${ROOT}/cuda/*.cu)
if(NOT sources)
  message(FATAL_ERROR "no sources under ${ROOT}/runtime")
endif()
# The baker's folders, which its own includes start with, and the libraries only it may use.
set(forbidden "baker/|(bind|chains|cli|clusters|fit|import|measure|mesh|motion|page|pipeline|play|report|rig|roles|segment|truth|wrap|write)/|(assimp|CGAL|Eigen|fmt|nlohmann|oneapi|tbb)/|tiny_gltf|CLI/")
set(found FALSE)
foreach(source ${sources})
  file(STRINGS ${source} lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^[^<\"]*[<\"]([^>\"]*)[>\"].*$" "\\1" included "${line}")
    if(included MATCHES "(^|/)(${forbidden})" OR
       # Public headers: the standard library, which has no slash, and of C two headers; and each other.
       (source MATCHES "/include/spherechain/" AND NOT included MATCHES "^(spherechain/[a-z_]+\\.h|[a-z]+|std(def|int)\\.h)$"))
      message(NOTICE "${source} includes ${included}")
      set(found TRUE)
    endif()
  endforeach()
endforeach()
if(found)
  message(FATAL_ERROR "an include that must not be there")
endif()
