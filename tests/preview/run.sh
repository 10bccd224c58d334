#!/usr/bin/env bash
# run.sh TOOL FOLDER: bakes the MakeHuman body with a preview and validates that; installs the validator in FOLDER.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
tool=$1
cd "$2"

command -v node >/dev/null && command -v npm >/dev/null || { echo "SKIPPED: preview.validator needs node and npm, and they are not installed"; exit 77; }
if ! cmp -s "$here/package-lock.json" package-lock.json || [[ ! -d node_modules/gltf-validator ]]; then
  cp "$here/package.json" "$here/package-lock.json" "$here/.npmrc" .
  npm ci --no-audit --no-fund
fi
"$tool" bake /usr/share/assimp/models/Collada/human.zae -o human.sphc --preview human.glb >/dev/null
node "$here/validate.js" human.glb
