#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Unpacks OUT/spherechain-VERSION-site.zip and reads it in headless Chromium, from disk: `scripts/release/try/site.sh OUT`.
set -euo pipefail
cd "$(dirname "$0")/../../.."
. scripts/release/common.sh

out=${1:?usage: site.sh OUT}
command -v chromium >/dev/null || skip "chromium is missing (Debian: chromium)"
unpack "$out/spherechain-$version-site.zip"
cp scripts/site/read.mjs build/site
node build/site/read.mjs "$work"/spherechain-*-site
