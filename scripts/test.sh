#!/usr/bin/env bash
# Every test: all of them in a release build, then all of them again under the address and undefined behaviour sanitizers.
# --fast: the runtime's tests, the samples and the rules alone, in release: a minute on a built tree.
set -euo pipefail
cd "$(dirname "$0")/.."

if [[ "${1:-}" == --fast ]]; then
  cmake --preset release >/dev/null
  cmake --build --preset release --target all
  scripts/lint.sh HEAD
  exec ctest --preset release --no-tests=error \
    -R '^(rules|sample|golden|csharp\.(native|palettes)|python\.(gradients|refusals))|^unit\.(runtime|contacts)$'
fi
scripts/install_packages.sh
for preset in release asan; do
  echo "== $preset"
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset"
  if [[ "$preset" == release ]]; then scripts/lint.sh HEAD~1; fi
  ctest --preset "$preset" --no-tests=error
done
