#!/usr/bin/env bash
# The runtime's tests, its golden hashes (tests/golden) and some fuzzing for 64-bit ARM, by Debian's cross compiler, run by qemu:
# NEON must give what x86 gives. `scripts/neon.sh [argument of test_runtime ...]`. Installs g++-aarch64-linux-gnu and qemu-user
# where it may. A few minutes, nearly all of it compilation, so test.sh does without.
set -euo pipefail
cd "$(dirname "$0")/.."

for command in aarch64-linux-gnu-g++ qemu-aarch64; do
  command -v "$command" >/dev/null && continue
  [[ $(id -u) -eq 0 ]] || { echo "neon: $command is missing: install g++-aarch64-linux-gnu and qemu-user first" >&2; exit 1; }
  echo "Installing g++-aarch64-linux-gnu and qemu-user"
  apt-get update -qq
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends g++-aarch64-linux-gnu qemu-user >/dev/null
  break
done
# The library needs only headers of other projects, the same for every machine. Static, so that qemu needs no foreign libraries.
cmake --preset release -B build/neon -DSPHERECHAIN_BAKER=OFF -DSPHERECHAIN_VIEWER=OFF -DSPHERECHAIN_BENCH=OFF \
  -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 \
  -DCMAKE_C_COMPILER=aarch64-linux-gnu-gcc -DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++ -DCMAKE_EXE_LINKER_FLAGS=-static \
  ${CMAKE_CXX_COMPILER_LAUNCHER:+-DCMAKE_CXX_COMPILER_LAUNCHER=$CMAKE_CXX_COMPILER_LAUNCHER} >/dev/null
cmake --build build/neon --target test_runtime golden fuzz_jobs
qemu-aarch64 build/neon/bin/test_runtime "$@"
qemu-aarch64 build/neon/bin/golden tests/golden
qemu-aarch64 build/neon/bin/fuzz_jobs --cases 2400
