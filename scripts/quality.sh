#!/usr/bin/env bash
# Every quality gate of tests/quality; those on characters of the folder that SPHERECHAIN_TEST_DATA names too, where it is set.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_packages.sh
cmake --preset release >/dev/null
cmake --build --preset release --target quality_gates
build/release/bin/quality_gates tests/quality/gates
