#!/usr/bin/env bash
# The paper's experiments on the MakeHuman body: CSV files and a page in out/paper. With --docs docs/paper.md that page is
# rewritten too; --quick takes fewer points.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_packages.sh
cmake --preset release >/dev/null
cmake --build --preset release --target paper_experiments
build/release/bin/paper_experiments -o out/paper "$@"
