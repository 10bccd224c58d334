#!/usr/bin/env bash
# The runtime's tests for Windows (x86-64), cross-compiled by mingw-w64 and run by wine: unit tests, golden hashes (tests/golden)
# and some fuzzing. `scripts/windows.sh [argument of test_runtime ...]`. Installs mingw-w64 and wine where it may. Some minutes,
# nearly all of it compilation, so test.sh does without. scripts/release/windows.sh makes the zip for Windows.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/release/windows_common.sh

"${configure[@]}" -B build/windows >/dev/null
cmake --build build/windows --target test_runtime golden fuzz_jobs write_tiny_asset

wine build/windows/bin/test_runtime.exe "$@"
wine build/windows/bin/golden.exe tests/golden
wine build/windows/bin/fuzz_jobs.exe --cases 2400

cmake --install build/windows --component sdk --prefix "$PWD/build/windows-static" >/dev/null
wine build/windows/bin/write_tiny_asset.exe build/windows/tiny.sphc
try_stranger "$PWD/build/windows-static" build/windows/tiny.sphc build/windows-stranger
