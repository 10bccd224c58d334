#!/usr/bin/env bash
# The format of every source, and clang-tidy over the runtime's sources that changed since BASE (default: the commit before
# the last one). Needs a built build/release. Usage: scripts/lint.sh [BASE]
set -euo pipefail
cd "$(dirname "$0")/.."

if ! git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
  echo "lint: skipped, this is no git checkout"
  exit 0
fi
git ls-files '*.h' '*.cpp' '*.cu' '*.cuh' | xargs clang-format --dry-run -Werror
base="$(git rev-parse --quiet --verify "${1:-HEAD~1}" || true)"
if [[ -z "$base" ]]; then
  echo "lint: clang-tidy is skipped, the clone has no earlier commit"
  exit 0
fi
git diff --name-only --diff-filter=d "$base" -- 'runtime/src/*.cpp' |
  xargs --no-run-if-empty clang-tidy -p build/release --quiet --warnings-as-errors='*' --extra-arg=-Qunused-arguments
