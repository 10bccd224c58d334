#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The plugin for Unreal Engine 5, as source with the runtime's libraries for Linux and Windows: `scripts/release/unreal.sh OUT`.
# Compiles for Windows by mingw-w64, and makes the import library for Microsoft's linker by llvm-dlltool.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/release/common.sh
out=$(mkdir -p "$1" && cd "$1" && pwd)
needs llvm-dlltool llvm
scripts/release/engines/runtimes.sh linux-static windows-shared

plugin=build/engines/unreal/Spherechain
library=$plugin/Source/ThirdParty/spherechain
binaries=$plugin/Binaries/ThirdParty/spherechain/Win64
rm -rf build/engines/unreal
mkdir -p $library/lib/Linux $library/lib/Win64 $binaries
cp -r runtime/unreal/* $plugin/
sed -i "s/\"VersionName\": \"0.0.0\"/\"VersionName\": \"$version\"/" $plugin/Spherechain.uplugin
cp runtime/LICENSE $plugin/
copy_notices $library/copyright
cp -r build/engines/linux-static/include $library/
strip --strip-debug -o $library/lib/Linux/libspherechain.a build/engines/linux-static/lib/libspherechain.a
x86_64-w64-mingw32-strip -o $binaries/spherechain.dll build/engines/windows-shared/bin/spherechain.dll
{ echo "LIBRARY spherechain.dll"; echo EXPORTS; exports_of $binaries/spherechain.dll; } >build/engines/unreal/spherechain.def
llvm-dlltool -m i386:x86-64 -d build/engines/unreal/spherechain.def -l $library/lib/Win64/spherechain.lib
find $plugin -type f -exec chmod 644 {} +
python3 scripts/release/archive.py $plugin "$out/spherechain-$version-unreal.zip"
echo "$out/spherechain-$version-unreal.zip"
