#!/usr/bin/env bash
# The SDK for Windows (x86-64), cross-compiled by mingw-w64 and run by wine: the runtime's tests, its golden hashes
# (tests/golden), some fuzzing and the samples, then the DLL: what it exports and imports, and a stranger's programs with it.
# `scripts/windows.sh [argument of test_runtime ...]`. Installs mingw-w64 and wine where it may. Some minutes, nearly all of
# it compilation, so test.sh does without. The samples play the assets that the tests of build/release have baked.
set -euo pipefail
cd "$(dirname "$0")/.."

for command in x86_64-w64-mingw32-g++-posix wine; do
  command -v "$command" >/dev/null && continue
  [[ $(id -u) -eq 0 ]] || { echo "windows: $command is missing: install g++-mingw-w64-x86-64-posix and wine64, wine first" >&2; exit 1; }
  echo "Installing g++-mingw-w64-x86-64-posix, wine64 and wine"
  apt-get update -qq
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends g++-mingw-w64-x86-64-posix wine64 wine >/dev/null
  break
done

# What the build needs of others is headers, the same for every machine; /usr/include as a whole would bring Linux's too.
root=$PWD/build/windows-root
rm -rf "$root"
mkdir -p "$root/include" "$root/lib/cmake/TinyGLTF"
for header in hwy flatbuffers doctest nlohmann tiny_gltf.h; do
  [[ -e /usr/include/$header ]] && ln -s "/usr/include/$header" "$root/include/"
done
cp -r /usr/lib/cmake/doctest /usr/share/cmake/nlohmann_json "$root/lib/cmake/"
sed -i "s|\"/usr\"|\"$root\"|" "$root"/lib/cmake/*/*Targets.cmake
cat >"$root/tiny_gltf.cpp" <<'EOF'
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
EOF
cat >"$root/lib/cmake/TinyGLTF/TinyGLTFConfig.cmake" <<'EOF'
if(NOT TARGET tinygltf)
  add_library(tinygltf STATIC ${SPHERECHAIN_WINDOWS_ROOT}/tiny_gltf.cpp)
  set_target_properties(tinygltf PROPERTIES UNITY_BUILD OFF CXX_STANDARD 17)
  target_compile_definitions(tinygltf PUBLIC TINYGLTF_NO_STB_IMAGE TINYGLTF_NO_STB_IMAGE_WRITE)
  target_include_directories(tinygltf SYSTEM PUBLIC ${SPHERECHAIN_WINDOWS_ROOT}/include)
  add_library(TinyGLTF::TinyGLTF ALIAS tinygltf)
endif()
EOF

export WINEPREFIX=$PWD/build/wine WINEDEBUG=-all
configure=(cmake -G Ninja --toolchain "$PWD/cmake/mingw.cmake" -D SPHERECHAIN_WINDOWS_ROOT="$root" -D CMAKE_BUILD_TYPE=Release
  -D SPHERECHAIN_WERROR=ON -D SPHERECHAIN_BAKER=OFF -D SPHERECHAIN_STUDIES=OFF -D SPHERECHAIN_CUDA=OFF
  ${CMAKE_CXX_COMPILER_LAUNCHER:+-D CMAKE_CXX_COMPILER_LAUNCHER=$CMAKE_CXX_COMPILER_LAUNCHER})
samples=(hello c_api load_and_refit crowd stop_at_contact duel)
"${configure[@]}" -B build/windows >/dev/null
cmake --build build/windows --target test_runtime golden fuzz_jobs write_tiny_asset "${samples[@]/#/sample_}"

wine build/windows/bin/test_runtime.exe "$@"
wine build/windows/bin/golden.exe tests/golden
wine build/windows/bin/fuzz_jobs.exe --cases 2400
