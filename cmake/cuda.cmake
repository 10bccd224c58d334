# SPHERECHAIN_CUDA: AUTO takes a CUDA compiler where there is one, ON fails without, OFF does not look. Sets
# SPHERECHAIN_CUDA_FOUND.
set(spherechain_cuda_default OFF)
if(PROJECT_IS_TOP_LEVEL)
  set(spherechain_cuda_default AUTO)
endif()
set(SPHERECHAIN_CUDA ${spherechain_cuda_default} CACHE STRING "Build the CUDA backend: AUTO (where a CUDA compiler is found), ON or OFF")
set_property(CACHE SPHERECHAIN_CUDA PROPERTY STRINGS AUTO ON OFF)
set(SPHERECHAIN_CUDA_FOUND FALSE)
if(NOT SPHERECHAIN_CUDA)
  return()
endif()

include(CheckLanguage)
if(NOT CMAKE_CUDA_COMPILER)
  find_program(SPHERECHAIN_NVCC nvcc HINTS ENV CUDA_PATH ENV CUDA_HOME PATHS /usr/local/cuda PATH_SUFFIXES bin)
  mark_as_advanced(SPHERECHAIN_NVCC)
  if(SPHERECHAIN_NVCC)
    set(CMAKE_CUDA_COMPILER ${SPHERECHAIN_NVCC})
  endif()
endif()
# Turing to Hopper (Ampere's code runs on Ada too), and PTX for what comes after; a tree for one machine says -DCMAKE_CUDA_ARCHITECTURES=native or 90.
if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
  set(CMAKE_CUDA_ARCHITECTURES 75-real 80-real 90)
endif()
check_language(CUDA)
if(CMAKE_CUDA_COMPILER)
  enable_language(CUDA)
  find_package(CUDAToolkit QUIET)
endif()
if(CMAKE_CUDA_COMPILER AND CUDAToolkit_FOUND)
  set(SPHERECHAIN_CUDA_FOUND TRUE)
elseif(SPHERECHAIN_CUDA STREQUAL "AUTO")
  message(STATUS "The CUDA backend is left out: no CUDA compiler found (set CUDACXX or CUDA_PATH)")
else()
  message(FATAL_ERROR "SPHERECHAIN_CUDA is ${SPHERECHAIN_CUDA}, but no CUDA compiler was found (set CUDACXX or CUDA_PATH)")
endif()

# The warnings and roundings of spherechain_target, for both of nvcc's compilers.
function(spherechain_cuda_target target)
  target_compile_options(${target} PRIVATE
    $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wconversion -Wpedantic -ffp-contract=off>
    $<$<COMPILE_LANG_AND_ID:CXX,Clang,AppleClang>:-Wno-sign-conversion>
    $<$<COMPILE_LANGUAGE:CUDA>:-fmad=false -Xcompiler=-Wall,-Wextra,-ffp-contract=off>
    $<$<BOOL:${SPHERECHAIN_WERROR}>:$<IF:$<COMPILE_LANGUAGE:CUDA>,-Werror=all-warnings,-Werror>>)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CUDA_STANDARD_REQUIRED ON)
endfunction()
