# Settings that every target of the project shares. Warnings and floating-point rules are PRIVATE: a consumer never inherits them.
function(spherechain_target target standard)
  target_compile_features(${target} PUBLIC cxx_std_${standard})
  # MSVC and clang-cl. /fp:precise lets clang-cl, and MSVC before Visual Studio 2022, fuse multiply-adds: see below.
  if(MSVC)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "MSVC" AND MSVC_VERSION LESS 1930)
      message(FATAL_ERROR "Visual Studio 2022 (MSVC 19.30) or newer is needed: older ones fuse multiply-adds, which changes results")
    endif()
    target_compile_options(${target} PRIVATE /W4 $<$<BOOL:${SPHERECHAIN_WERROR}>:/WX> /fp:precise
      $<$<CXX_COMPILER_ID:Clang>:/clang:-ffp-contract=off>)
    return()
  endif()
  if(MINGW)  # %zu and %llu as in C99, also where a program runs on the old msvcrt.dll
    target_compile_definitions(${target} PRIVATE __USE_MINGW_ANSI_STDIO=1)
  endif()
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wconversion -Wpedantic $<$<BOOL:${SPHERECHAIN_WERROR}>:-Werror>
    # GCC's -Wconversion leaves signs alone in C++; Clang's does not.
    $<$<COMPILE_LANG_AND_ID:CXX,Clang,AppleClang>:-Wno-sign-conversion>
    # One arithmetic everywhere: a fused multiply-add rounds once instead of twice, so pairs would differ between machines.
    -ffp-contract=off
    # GCC 12 takes (double)(float)x of two doubles side by side for x, and leaves out the rounding.
    $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fno-tree-slp-vectorize>
    # The stack of Windows is aligned to 16 bytes, and GCC's spills of AVX registers trust in 32 (its bug 54412). Debian's
    # GCC is patched; for others the assembler makes the aligned moves unaligned ones.
    $<$<BOOL:${spherechain_moves}>:-Wa,-muse-unaligned-vector-move>)
endfunction()

set(spherechain_moves OFF)
if(MINGW AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  include(CheckCXXCompilerFlag)
  check_cxx_compiler_flag(-Wa,-muse-unaligned-vector-move SPHERECHAIN_UNALIGNED_VECTOR_MOVE)
  if(NOT SPHERECHAIN_UNALIGNED_VECTOR_MOVE)
    message(FATAL_ERROR "This MinGW's assembler lacks -muse-unaligned-vector-move: binutils 2.38 or newer is needed, else AVX crashes")
  endif()
  set(spherechain_moves ON)
endif()

# Files that are a plain interface to CGAL. The preset asan checks nothing in them: four fifths of a bake's time under all
# checks went into CGAL's own code.
function(spherechain_cgal_sources)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "${SPHERECHAIN_CGAL_FLAGS}")
endfunction()
