#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Packs the Blender add-on into OUT: `scripts/release/blender.sh OUT`. The .zip holds one folder: Blender 3.4's "Install..." needs
# the folder, and 4.2's "Install from Disk" finds the manifest in it. Blender 3.4 imports the add-on by the folder's name, so that
# name differs from the Python package `spherechain`, which can be on Blender's path.
set -euo pipefail
[[ $# -eq 1 ]] || { echo "usage: scripts/release/blender.sh OUT" >&2; exit 2; }
cd "$(dirname "$0")/../.."
. scripts/release/common.sh

work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
mkdir -p "$1" "$work/spherechain_blender"
git ls-files -z baker/blender | xargs -0 -I{} cp {} "$work/spherechain_blender/"
cp baker/LICENSE "$work/spherechain_blender/"
sed -i "s/^version = .*/version = \"$version\"/" "$work/spherechain_blender/blender_manifest.toml"
sed -i "s/^    \"version\": .*/    \"version\": (${version//./, }),/" "$work/spherechain_blender/__init__.py"
out=$1/spherechain-$version-blender.zip
scripts/release/archive.py "$work/spherechain_blender" "$out"
echo "$out ($(stat -c %s "$out") bytes)"
