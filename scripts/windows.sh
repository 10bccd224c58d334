#!/usr/bin/env bash
# The SDK for Windows (x86-64), cross-compiled by mingw-w64 and run by wine: the runtime's tests, its golden hashes
# (tests/golden) and some fuzzing; then the zip for Windows: what its DLL exports, a stranger's programs, its samples.
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
"${configure[@]}" -B build/windows >/dev/null
cmake --build build/windows --target test_runtime golden fuzz_jobs write_tiny_asset

wine build/windows/bin/test_runtime.exe "$@"
wine build/windows/bin/golden.exe tests/golden
wine build/windows/bin/fuzz_jobs.exe --cases 2400

# The SDK as a DLL, in the zip that is shipped.
"${configure[@]}" -B build/windows-dll -D BUILD_SHARED_LIBS=ON -D SPHERECHAIN_TESTS=OFF >/dev/null
cmake --build build/windows-dll
rm -rf build/windows-sdk build/windows-dll/packages
cpack --config build/windows-dll/CPackConfig.cmake -G ZIP >/dev/null
cmake -E make_directory build/windows-sdk
zip=$(ls "$PWD"/build/windows-dll/packages/*.zip)
(cd build/windows-sdk && cmake -E tar xf "$zip")
sdk=$(ls -d "$PWD"/build/windows-sdk/*)

# Exactly what the headers declare leaves the DLL, and it needs no DLL but those of every Windows.
dump=$(x86_64-w64-mingw32-objdump -p "$sdk/bin/spherechain.dll")
exported=$(sed -n '/Ordinal\/Name Pointer/,/^$/p' <<<"$dump" | awk '/\[/ && $NF !~ /Table$/ {print $NF}' | sort)
declared=$(grep -hoE 'SPHERECHAIN_API .*\bsc_[a-z_]+\(' "$sdk"/include/spherechain/*.h | grep -oE 'sc_[a-z_]+\($' | tr -d '(' | sort -u)
diff <(echo "$declared") <(echo "$exported") || { echo "windows: < is declared, > is exported" >&2; exit 1; }
imported=$(sed -n 's/^[\t ]*DLL Name: //p' <<<"$dump" | sort | tr '\n' ' ')
[[ $imported == "KERNEL32.dll msvcrt.dll " ]] || { echo "windows: the DLL needs $imported" >&2; exit 1; }
echo "spherechain.dll: $(wc -l <<<"$exported") functions, needs $imported"

# A stranger's project, with the DLL, then with the archive: 60 spheres, 175 pairs.
cmake --install build/windows --component sdk --prefix "$PWD/build/windows-static" >/dev/null
wine build/windows/bin/write_tiny_asset.exe build/windows/tiny.sphc
for prefix in "$sdk" "$PWD/build/windows-static"; do
  stranger=build/windows-stranger
  rm -rf $stranger
  cmake -G Ninja --toolchain "$PWD/cmake/mingw.cmake" -S tests/package/stranger -B $stranger \
    -D spherechain_DIR="$prefix/lib/cmake/spherechain" >/dev/null
  cmake --build $stranger >/dev/null
  [[ ! -d $prefix/bin ]] || cp "$prefix"/bin/*.dll $stranger
  for program in stranger_c stranger_cpp; do
    wine $stranger/$program.exe build/windows/tiny.sphc | tr -d '\r' | diff - <(echo "60 spheres, 175 pairs, 4 pairs of body parts")
  done
done

# The zip's samples, built as its reader would; they print what Linux's print.
cmake -G Ninja --toolchain "$PWD/cmake/mingw.cmake" -S "$sdk/samples" -B build/windows-samples -D CMAKE_BUILD_TYPE=Release \
  -D SPHERECHAIN_WINDOWS_ROOT="$root" -D spherechain_DIR="$sdk/lib/cmake/spherechain" >/dev/null
cmake --build build/windows-samples
asset=build/release/samples/own_bones.sphc model=build/release/samples/human.glb
for sample in hello c_api load_and_refit crowd stop_at_contact duel; do
  if [[ ! -e $asset || ! -e $model || ! -x build/release/bin/$sample ]]; then
    echo "windows: $sample is not compared: build/release has no sample of Linux, or its tests have baked no asset (ctest --preset release -R sample)" >&2
    missing=1
    continue
  fi
  wine build/windows-samples/$sample.exe $asset $model | tr -d '\r' | sed 's/[0-9.]* us / us /' >build/windows-samples/$sample.txt
  "build/release/bin/$sample" $asset $model | sed 's/[0-9.]* us / us /' | diff - build/windows-samples/$sample.txt
  echo "$sample: $(wc -l <build/windows-samples/$sample.txt) lines as on Linux"
done
echo "$zip"
exit "${missing:-0}"
