#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the runtime for the packages of game engines: `runtimes.sh KIND ...`, into build/engines/KIND, for the kinds
#   linux-shared linux-static windows-shared windows-static web-static
# Each has include/ and lib/ or bin/. A package takes the files that it needs. Installs mingw-w64 or emscripten where it may.
set -euo pipefail
cd "$(dirname "$0")/../../.."
. scripts/release/common.sh

# A cross compiler needs only the headers of FlatBuffers and Highway. All of /usr/include would bring Linux's too.
headers=$PWD/build/engines/headers
mkdir -p "$headers"
ln -sfn /usr/include/hwy "$headers/hwy"
ln -sfn /usr/include/flatbuffers "$headers/flatbuffers"

for kind in "$@"; do
  options=(-G Ninja -D CMAKE_BUILD_TYPE=Release -D SPHERECHAIN_WERROR=ON -D SPHERECHAIN_BAKER=OFF -D SPHERECHAIN_TESTS=OFF
    -D SPHERECHAIN_STUDIES=OFF -D SPHERECHAIN_CUDA=OFF -D SPHERECHAIN_PYTHON=OFF -D SPHERECHAIN_JAVASCRIPT=OFF
    ${CMAKE_CXX_COMPILER_LAUNCHER:+-D CMAKE_CXX_COMPILER_LAUNCHER=$CMAKE_CXX_COMPILER_LAUNCHER}
    -D BUILD_SHARED_LIBS="$([[ $kind == *-shared ]] && echo ON || echo OFF)")
  configure=(cmake)
  case $kind in
    linux-*) ;;
    windows-*)
      needs x86_64-w64-mingw32-g++-posix g++-mingw-w64-x86-64-posix
      options+=(--toolchain "$PWD/cmake/mingw.cmake" -D SPHERECHAIN_WINDOWS_ROOT="$headers"
        -D SPHERECHAIN_HIGHWAY_INCLUDE_DIR="$headers" -D SPHERECHAIN_FLATBUFFERS_INCLUDE_DIR="$headers") ;;
    web-static)
      needs emcc emscripten
      configure=(emcmake cmake)
      options+=(-D CMAKE_CXX_FLAGS="-msimd128 -DHWY_COMPILE_ONLY_STATIC"
        -D SPHERECHAIN_HIGHWAY_INCLUDE_DIR="$headers" -D SPHERECHAIN_FLATBUFFERS_INCLUDE_DIR="$headers") ;;
    *) echo "runtimes: there is no kind $kind" >&2; exit 2 ;;
  esac
  "${configure[@]}" -S . -B "build/engines/build-$kind" "${options[@]}" >"build/engines/$kind.log" 2>&1 &&
    cmake --build "build/engines/build-$kind" >>"build/engines/$kind.log" 2>&1 ||
    { tail -n 30 "build/engines/$kind.log" >&2; exit 1; }
  rm -rf "build/engines/$kind"
  cmake --install "build/engines/build-$kind" --component sdk --prefix "$PWD/build/engines/$kind" >/dev/null
done
