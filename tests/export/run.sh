#!/usr/bin/env bash
# run.sh FOLDER SCRIPT ARGUMENTS...: runs SCRIPT of this folder with node in FOLDER, where npm installs the foreign engines.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
folder=$1 script=$2
shift 2
mkdir -p "$folder"
cd "$folder"

command -v node >/dev/null && command -v npm >/dev/null || { echo "SKIPPED: export needs node and npm, and they are not installed"; exit 77; }
if ! cmp -s "$here/package-lock.json" package-lock.json || [[ ! -d node_modules/three ]]; then
  cp "$here/package.json" "$here/package-lock.json" "$here/.npmrc" .
  npm ci --no-audit --no-fund
fi
cp "$here"/*.mjs "$here"/*.cs "$here"/*.py .
exec node "$script" "$@"
