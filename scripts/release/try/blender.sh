#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs the .zip of scripts/release/blender.sh in a Blender without settings, and checks, mends and masks a character:
# `scripts/release/try/blender.sh OUT [--install]`. The tool is that of build/release, or the one on PATH. Four minutes. A stand-in
# for the Python package `spherechain` is on Blender's path, as the wheel is if Blender starts from a terminal with an active venv.
# --install first installs Debian's Blender. Without Blender it prints "skipped" and exits 77.
set -euo pipefail
[[ $# -ge 1 ]] || { echo "usage: scripts/release/try/blender.sh OUT [--install]" >&2; exit 2; }
out=$(realpath "$1")
cd "$(dirname "$0")/../../.."
. scripts/release/common.sh

[[ ${2:-} != --install ]] || needs blender blender
command -v blender >/dev/null || skip "no Blender here; --install installs Debian's"
models=/usr/share/assimp/models
[[ -e $models/Collada/human.zae ]] || skip "no $models (Debian's assimp-testmodels)"
[[ -x build/release/bin/spherechain ]] && export PATH=$PWD/build/release/bin:$PATH
command -v spherechain >/dev/null || skip "no spherechain in build/release/bin or on PATH"
zip=$out/spherechain-$version-blender.zip
[[ -e $zip ]] || { echo "try/blender: no $zip: run scripts/release/blender.sh first" >&2; exit 1; }

try=$(mktemp -d)
trap 'rm -r "$try"' EXIT
export BLENDER_USER_CONFIG=$try/config BLENDER_USER_SCRIPTS=$try/scripts BLENDER_USER_DATAFILES=$try/data
mkdir -p "$try/python/spherechain"
touch "$try/python/spherechain/__init__.py"
export PYTHONPATH=$try/python
blender_python() { blender -b --factory-startup --python-use-system-env --python-exit-code 1 --python "$@" >"$try/log" 2>&1 || { cat "$try/log"; exit 1; }; grep -a '^trial: ' "$try/log" || true; }

# The first two seconds of a man who walks. `--parts` names a part without faults, so that the clip keeps its own.
awk '/^Frames:/ {$0 = "Frames: 240"} {print} /^Frame Time/ {left = 241} left && !--left {exit}' $models/BVH/01_01.bvh >"$try/walk.bvh"
spherechain fix $models/Collada/human.zae --motion "$try/walk.bvh" --parts "left foot" -o "$try/walk.glb" >/dev/null 2>&1
spherechain check "$try/walk.glb" -o "$try/report" --fps 30 --json "$try/walk.json" >/dev/null 2>&1 || [[ $? -eq 6 ]]

blender_python tests/blender/install.py -- "$zip"
python3 tests/blender/plain.py 2>&1 | tail -1
blender_python tests/blender/character.py -- "$try/walk.glb" "$try/walk.json"
echo "$(basename "$zip"): installed, checked, mended and masked"
