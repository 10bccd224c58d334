#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Packs the Blender add-on into OUT: `scripts/release/blender.sh OUT`. The .zip holds one folder: Blender 3.4's "Install..." needs
# the folder, and 4.2's "Install from Disk" finds the manifest in it.
set -euo pipefail
[[ $# -eq 1 ]] || { echo "usage: scripts/release/blender.sh OUT" >&2; exit 2; }
cd "$(dirname "$0")/../.."
. scripts/release/common.sh

work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
mkdir -p "$1" "$work/spherechain"
git ls-files -z baker/blender | xargs -0 -I{} cp {} "$work/spherechain/"
cp baker/LICENSE "$work/spherechain/"
sed -i "s/^version = .*/version = \"$version\"/" "$work/spherechain/blender_manifest.toml"
sed -i "s/^    \"version\": .*/    \"version\": (${version//./, }),/" "$work/spherechain/__init__.py"
out=$1/spherechain-$version-blender.zip
scripts/release/archive.py "$work/spherechain" "$out"
echo "$out ($(stat -c %s "$out") bytes)"
