#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The SDK for Windows (x86-64) as a DLL, with its samples: `scripts/release/windows.sh OUT`. Cross-compiled by mingw-w64, in
# build/windows-dll. Installs mingw-w64 and wine where it may.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/release/windows_common.sh

"${configure[@]}" -B build/windows-dll -D BUILD_SHARED_LIBS=ON -D SPHERECHAIN_TESTS=OFF >/dev/null
cmake --build build/windows-dll >/dev/null
stage=build/release-stage/windows name=spherechain-$version-windows-x86_64
rm -rf $stage
for component in sdk samples; do
  cmake --install build/windows-dll --component $component --prefix "$stage/$name" --strip >/dev/null
done
copy_notices "$stage/$name/share/doc/spherechain/copyright"
python3 scripts/release/archive.py "$stage/$name" "$1/spherechain-sdk-$version-windows-x86_64.zip"
ls "$1/spherechain-sdk-$version-windows-x86_64.zip"
