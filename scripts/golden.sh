#!/usr/bin/env bash
# The golden hashes (tests/golden) by other compilers and optimization levels than the release build's: all must be the same.
# `scripts/golden.sh`. Builds the runtime once each, a minute or two, in build/golden-*. What is not installed is left out and said.
set -euo pipefail
cd "$(dirname "$0")/.."

for build in "g++ -O0" "clang++-14 -O2"; do
  read -r compiler level <<<"$build"
  if ! command -v "$compiler" >/dev/null; then
    echo "golden: $compiler is missing: not compared" >&2
    missing=1
    continue
  fi
  folder=build/golden-$compiler$level
  cmake --preset release -B "$folder" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS_RELEASE="$level" -DSPHERECHAIN_BAKER=OFF \
    -DSPHERECHAIN_VIEWER=OFF -DSPHERECHAIN_STUDIES=OFF ${CMAKE_CXX_COMPILER_LAUNCHER:+-DCMAKE_CXX_COMPILER_LAUNCHER=$CMAKE_CXX_COMPILER_LAUNCHER} >/dev/null
  cmake --build "$folder" --target golden >"$folder/build.log" || { cat "$folder/build.log"; exit 1; }
  echo -n "$build: "
  "$folder/bin/golden" tests/golden
done
exit "${missing:-0}"
