#!/usr/bin/env bash
# Every test: all of them in a release build, then all of them again under the address and undefined behaviour sanitizers.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_packages.sh
for preset in release asan; do
  echo "== $preset"
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset"
  ctest --preset "$preset" --no-tests=error
done
