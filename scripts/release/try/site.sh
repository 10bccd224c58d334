#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Unpacks OUT/spherechain-VERSION-site.zip and reads it in headless Chromium, from disk: `scripts/release/try/site.sh OUT`.
set -euo pipefail
cd "$(dirname "$0")/../../.."

out=${1:?usage: site.sh OUT}
command -v chromium >/dev/null || { echo "skipped: chromium is missing (Debian: chromium)"; exit 77; }
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
python3 -m zipfile -e "$out"/spherechain-*-site.zip "$work"
cp scripts/site/read.mjs build/site
node build/site/read.mjs "$work"/spherechain-*-site
