#!/usr/bin/env bash
# The runtime's tests, its golden hashes (tests/golden) and some fuzzing as WebAssembly, by Debian's emscripten, run by Node:
# SIMD of 128 bits and 32-bit pointers must give what x86 gives. `scripts/wasm.sh [argument of test_runtime ...]`. A few minutes,
# nearly all of it compilation, so test.sh does without: it tests the package (javascript.*).
set -euo pipefail
cd "$(dirname "$0")/.."

for command in emcc node; do
  command -v "$command" >/dev/null || { echo "wasm: $command is missing: install emscripten and nodejs first" >&2; exit 1; }
done
# The tests need only headers of other projects, the same for every machine; all of /usr/include would bring Linux's too.
root=$PWD/build/wasm-root
rm -rf "$root"
mkdir -p "$root/include" "$root/lib/cmake"
for header in hwy flatbuffers doctest; do ln -s "/usr/include/$header" "$root/include/"; done
cp -r /usr/lib/cmake/doctest "$root/lib/cmake/"
sed -i "s|\"/usr\"|\"$root\"|" "$root"/lib/cmake/*/*Targets.cmake

# The tests throw; the package's runtime does not. Links with -O1: above that emcc asks Node for acorn, which a Node that is not
# Debian's does not find.
emcmake cmake --preset release -B build/wasm-tests -DSPHERECHAIN_BAKER=OFF -DSPHERECHAIN_STUDIES=OFF -DSPHERECHAIN_CUDA=OFF -DSPHERECHAIN_PYTHON=OFF \
  -DSPHERECHAIN_HIGHWAY_INCLUDE_DIR="$root/include" -DSPHERECHAIN_FLATBUFFERS_INCLUDE_DIR="$root/include" -Ddoctest_DIR="$root/lib/cmake/doctest" \
  -DCMAKE_CXX_FLAGS="-msimd128 -fexceptions" -DCMAKE_EXE_LINKER_FLAGS="-sNODERAWFS=1 -sALLOW_MEMORY_GROWTH=1 -sTOTAL_STACK=4mb -O1" >/dev/null
cmake --build build/wasm-tests --target test_runtime golden fuzz_jobs
run() { node --no-experimental-fetch "build/wasm-tests/bin/$1.js" "${@:2}"; }  # emscripten 3.1.6 would fetch a file
run golden "$PWD/tests/golden"
run fuzz_jobs --cases 2400
run test_runtime --test-case-exclude='four threads*' "$@"  # there are none
