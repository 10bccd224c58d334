# Sets SPHERECHAIN_CSHARP_MISSING to what the tests of runtime/csharp lack here, or to nothing. Debian: mono-mcs, mono-runtime.
find_program(SPHERECHAIN_MCS mcs)
find_program(SPHERECHAIN_MONO mono)
mark_as_advanced(SPHERECHAIN_MCS SPHERECHAIN_MONO)
set(SPHERECHAIN_CSHARP_MISSING)
if(CMAKE_CROSSCOMPILING)
  set(SPHERECHAIN_CSHARP_MISSING "the build is for another machine")
elseif(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  set(SPHERECHAIN_CSHARP_MISSING "mono does not load a library with sanitizers")
elseif(NOT SPHERECHAIN_MCS)
  set(SPHERECHAIN_CSHARP_MISSING "mcs is missing (Debian: mono-mcs)")
elseif(NOT SPHERECHAIN_MONO)
  set(SPHERECHAIN_CSHARP_MISSING "mono is missing (Debian: mono-runtime)")
endif()

set(SPHERECHAIN_CSHARP_SOURCES ${PROJECT_SOURCE_DIR}/runtime/csharp/Spherechain.Native.cs
  ${PROJECT_SOURCE_DIR}/runtime/csharp/Spherechain.cs ${PROJECT_SOURCE_DIR}/runtime/csharp/Spherechain.Body.cs
  ${PROJECT_SOURCE_DIR}/runtime/csharp/Spherechain.Response.cs)

# A program of C# sources, into <build>/csharp.
function(spherechain_csharp_program name)
  set(program ${CMAKE_BINARY_DIR}/csharp/${name}.exe)
  # The oldest language that the sources promise; a warning is an error.
  add_custom_command(OUTPUT ${program}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/csharp
    COMMAND ${SPHERECHAIN_MCS} -unsafe -langversion:6 -warnaserror -optimize+ -r:System.Core -out:${program} ${ARGN}
    DEPENDS ${ARGN} COMMENT "mcs ${name}.exe" VERBATIM)
  add_custom_target(csharp_${name} ALL DEPENDS ${program})
endfunction()
