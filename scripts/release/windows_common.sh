# SPDX-License-Identifier: MIT
# Sourced by what builds for Windows, from the repository's root: installs mingw-w64 and wine where it may, and makes
# build/windows-root. Sets `root`, and `configure`, the command that configures a build.
. scripts/release/common.sh
needs x86_64-w64-mingw32-g++-posix g++-mingw-w64-x86-64-posix
needs wine wine64 wine

# The build needs only headers of other projects, the same for every machine; all of /usr/include would bring Linux's too.
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

# try_stranger PREFIX ASSET BUILD: a stranger's project with the SDK in PREFIX finds the contacts of the tiny asset.
try_stranger() {
  rm -rf "$3"
  cmake -G Ninja --toolchain "$PWD/cmake/mingw.cmake" -S tests/package/stranger -B "$3" -D spherechain_DIR="$1/lib/cmake/spherechain" >/dev/null
  cmake --build "$3" >/dev/null
  [[ ! -d $1/bin ]] || cp "$1"/bin/*.dll "$3"
  local program
  for program in stranger_c stranger_cpp; do
    wine "$3/$program.exe" "$2" | tr -d '\r' | diff - <(echo "$tiny_contacts")
  done
}
