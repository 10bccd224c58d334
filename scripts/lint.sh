#!/usr/bin/env bash
# The format of every source; with BASE also clang-tidy over the runtime's sources that changed since that commit, for which
# build/release must be built. Usage: scripts/lint.sh [BASE]
set -euo pipefail
cd "$(dirname "$0")/.."

if ! git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
  echo "lint: skipped, this is no git checkout"
  exit 0
fi
git ls-files '*.h' '*.cpp' '*.cu' '*.cuh' | xargs clang-format --dry-run -Werror
if [[ $# -gt 0 ]] && git rev-parse --quiet --verify "$1" >/dev/null; then
  git diff --name-only --diff-filter=d "$1" -- 'runtime/src/*.cpp' |
    xargs --no-run-if-empty clang-tidy -p build/release --quiet --warnings-as-errors='*' --extra-arg=-Qunused-arguments
fi
