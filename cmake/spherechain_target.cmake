# What every target of the project has in common. Warnings and floating-point rules are PRIVATE: a consumer never inherits them.
function(spherechain_target target standard)
  target_compile_features(${target} PUBLIC cxx_std_${standard})
  if(MSVC)
    target_compile_options(${target} PRIVATE /W4 $<$<BOOL:${SPHERECHAIN_WERROR}>:/WX> /fp:precise)
    return()
  endif()
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wconversion -Wpedantic $<$<BOOL:${SPHERECHAIN_WERROR}>:-Werror>
    # GCC's -Wconversion leaves signs alone in C++; Clang's does not.
    $<$<COMPILE_LANG_AND_ID:CXX,Clang,AppleClang>:-Wno-sign-conversion>
    # One arithmetic everywhere: a fused multiply-add rounds once instead of twice, so pairs would differ between machines.
    -ffp-contract=off
    # GCC 12 takes (double)(float)x of two doubles side by side for x, and leaves out the rounding.
    $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fno-tree-slp-vectorize>)
endfunction()

# Files that are a plain interface to CGAL. The preset asan checks the heap in them and no more: four fifths of a bake's
# time under all checks went into CGAL's own code.
function(spherechain_cgal_sources)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "${SPHERECHAIN_CGAL_FLAGS}")
endfunction()
