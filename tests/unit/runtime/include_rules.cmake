# SPDX-License-Identifier: MIT
# cmake -D ROOT=<repository> -P include_rules.cmake: fails on an include that runtime/, cuda/ or a stage of the baker must
# not have, and on an import that a folder of the page must not have.

# The folders of the runtime and of the baker. Each may include those before it and itself.
set(rooms base simd asset pose refit pairs triangles skin clusters contacts depth gaps inside penetrations step bodies response crowd)
set(room_size 15)  # files
set(stages mesh os import roles segment wrap fit chains rig bind edits clusters layers write calibrate pipeline motion play volumes filter mask truth report events
  page check fix score export cli)

file(GLOB_RECURSE sources ${ROOT}/runtime/*.h ${ROOT}/runtime/*.cpp ${ROOT}/runtime/*.cc ${ROOT}/runtime/*.inl
  ${ROOT}/cuda/*.h ${ROOT}/cuda/*.cuh ${ROOT}/cuda/*.cpp ${ROOT}/cuda/*.cu)
file(GLOB_RECURSE baker_sources ${ROOT}/baker/*.h ${ROOT}/baker/*.cpp)
if(NOT sources OR NOT baker_sources)
  message(FATAL_ERROR "no sources under ${ROOT}/runtime or ${ROOT}/baker")
endif()
set(found FALSE)
macro(refuse source included)
  message(NOTICE "${source} includes ${included}")
  set(found TRUE)
endmacro()
# The names in a file's include lines.
function(includes_of source result)
  file(STRINGS ${source} lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
  list(TRANSFORM lines REPLACE "^[^<\"]*[<\"]([^>\"]*)[>\"].*$" "\\1")
  set(${result} ${lines} PARENT_SCOPE)
endfunction()

# Runtime and CUDA: nothing of the baker, and no library that only the baker may use.
set(forbidden "(baker|studies|assimp|CGAL|Eigen|fmt|nlohmann|oneapi|tbb)/|tiny_gltf|CLI/")
foreach(source ${sources})
  includes_of(${source} all)
  foreach(included IN LISTS all)
    if(included MATCHES "(^|/)(${forbidden})" OR
       # Public headers: the standard library, which has no slash, and of C two headers; and each other.
       (source MATCHES "/include/spherechain/" AND NOT included MATCHES "^(spherechain/[a-z_]+\\.h|[a-z]+|std(def|int)\\.h)$"))
      refuse(${source} ${included})
    endif()
  endforeach()
endforeach()

# Refuses what includes a folder of `top` that comes later in the list `order`, and folders that the list lacks.
macro(check_order top)
  foreach(source ${ARGN})
    file(RELATIVE_PATH path ${ROOT}/${top} ${source})
    string(REGEX REPLACE "/.*" "" folder ${path})
    list(FIND order ${folder} own)
    if(own EQUAL -1)
      message(FATAL_ERROR "${top}/${folder} is missing in the lists of include_rules.cmake")
    endif()
    includes_of(${source} all)
    foreach(included IN LISTS all)
      string(REGEX MATCH "^${top}/([^/]+)/" is_inside ${included})
      list(FIND order "${CMAKE_MATCH_1}" place)
      if(is_inside AND place GREATER own)
        refuse(${source} ${included})
      elseif(included MATCHES "^studies/")
        refuse(${source} ${included})
      endif()
    endforeach()
  endforeach()
endmacro()
file(GLOB room_sources ${ROOT}/runtime/src/*/*.h ${ROOT}/runtime/src/*/*.cpp)
set(order ${rooms})
check_order(runtime/src ${room_sources})
set(order ${stages})
check_order(baker ${baker_sources})

foreach(room ${rooms})
  file(GLOB files ${ROOT}/runtime/src/${room}/*)
  list(LENGTH files count)
  if(count GREATER room_size)
    message(NOTICE "runtime/src/${room} has ${count} files, more than ${room_size}")
    set(found TRUE)
  endif()
endforeach()

# The folders of the page. Each may import from those before it and itself. Files beside the folders put them together.
set(rooms base model scene panels editor)
file(GLOB_RECURSE page_sources ${ROOT}/baker/page/web/src/*.js)
foreach(source ${page_sources})
  file(RELATIVE_PATH path ${ROOT}/baker/page/web/src ${source})
  string(REGEX REPLACE "/.*" "" room ${path})
  if(path MATCHES "/" AND NOT room STREQUAL "report")
    list(FIND rooms ${room} own)
    if(own EQUAL -1)
      message(FATAL_ERROR "${room} is missing in the list of rooms of include_rules.cmake")
    endif()
    file(STRINGS ${source} lines REGEX "^(import|export).*'\\.\\./")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^.*'\\.\\./([^']*)'.*$" "\\1" imported "${line}")
      string(REGEX REPLACE "/.*" "" other ${imported})
      list(FIND rooms ${other} place)
      if(place EQUAL -1 OR place GREATER own)
        refuse(${source} ${imported})
      endif()
    endforeach()
  endif()
endforeach()

if(found)
  message(FATAL_ERROR "an include that must not be there")
endif()
