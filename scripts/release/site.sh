#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The documents as pages, packed: OUT/spherechain-VERSION-site.zip. `scripts/release/site.sh OUT`.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/release/common.sh

out=${1:?usage: site.sh OUT}
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
scripts/site.sh "$work/spherechain-$version-site" >&2
copy_notices "$work/spherechain-$version-site/copyright"  # the demo holds the library
mkdir -p "$out"
scripts/release/archive.py "$work/spherechain-$version-site" "$out/spherechain-$version-site.zip"
echo "$out/spherechain-$version-site.zip"
