#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs the npm packages in an empty folder without a network, bakes a character and finds its first contacts:
# `scripts/release/try/npm.sh OUT`. Then the library alone, whose command says what is missing.
set -euo pipefail
cd "$(dirname "$0")/../../.."
. scripts/release/common.sh

command -v npm >/dev/null || skip "npm is missing"
model=/usr/share/assimp/models/Collada/human.zae
[[ -e $model ]] || skip "$model is missing (Debian: assimp-testmodels)"
library=$(realpath "$1/spherechain-$version.tgz") tool=$(realpath "$1/spherechain-linux-x64-$version.tgz")
size=$(stat -c %s "$library")
[[ $size -le 1000000 ]] || { echo "the library has $size bytes: more than a megabyte" >&2; exit 1; }
try=$(mktemp -d)
trap 'rm -rf "$try"' EXIT
export npm_config_cache=$try/cache npm_config_offline=true npm_config_audit=false npm_config_fund=false npm_config_update_notifier=false

# The sample of the documentation, word for word.
sed -n '/^import { readFileSync }/,/^```/p' docs/javascript.md | sed '/^```/,$d' >"$try/first.mjs"
mkdir "$try/both" "$try/alone"
mv "$try/first.mjs" "$try/both/"
cd "$try/both"
echo '{ "private": true }' >package.json
npm install --silent "$library" "$tool"
npx --no-install spherechain --version
npx --no-install spherechain bake "$model" -o human.sphc >log 2>&1 || { cat log; exit 1; }
node first.mjs | tee found
grep -q ' mm' found
if npx --no-install spherechain bake nothing.glb -o x.sphc 2>/dev/null; then exit 1; else [[ $? -eq 3 ]]; fi

cd "$try/alone"
echo '{ "private": true }' >package.json
npm install --silent "$library"
node --input-type=module -e "import { load } from 'spherechain'; await load(); console.log('the library alone: loads')"
said=$(npx --no-install spherechain --version 2>&1 || true)
[[ $said == *'the tool is not installed'* ]] || { echo "the command says: $said" >&2; exit 1; }
echo "the library alone: the command says what is missing"
