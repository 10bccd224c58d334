#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The addon for Godot 4, for Linux and Windows: `scripts/release/godot.sh OUT`. Compiles for Windows by mingw-w64.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/release/common.sh
out=$(mkdir -p "$1" && cd "$1" && pwd)
scripts/release/engines/runtimes.sh linux-static windows-static

addon=build/engines/godot/addons/spherechain
rm -rf build/engines/godot
mkdir -p $addon/bin
for system in linux windows; do
  options=(-D CMAKE_PREFIX_PATH="$PWD/build/engines/$system-static" -D CMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)
  ending=so strip=strip
  if [[ $system == windows ]]; then
    options=(--toolchain "$PWD/cmake/mingw.cmake" -D CMAKE_MODULE_LINKER_FLAGS=-static
      -D spherechain_DIR="$PWD/build/engines/windows-static/lib/cmake/spherechain")
    ending=dll strip=x86_64-w64-mingw32-strip
  fi
  cmake -G Ninja -S runtime/godot -B build/engines/build-godot-$system -D CMAKE_BUILD_TYPE=Release "${options[@]}" >/dev/null
  cmake --build build/engines/build-godot-$system >/dev/null
  $strip -o $addon/bin/libspherechain_godot.$system.x86_64.$ending build/engines/build-godot-$system/libspherechain_godot.$ending
done
cp runtime/godot/spherechain.gdextension runtime/godot/example.gd runtime/godot/README.md runtime/LICENSE $addon/
copy_notices $addon/copyright
find $addon -type f -exec chmod 644 {} +
python3 scripts/release/archive.py --flat build/engines/godot "$out/spherechain-$version-godot.zip"
echo "$out/spherechain-$version-godot.zip"
