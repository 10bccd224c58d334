#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The Unity package, as a tarball for the Package Manager: `scripts/release/unity.sh OUT`. It holds the C# classes, the samples
# and the libraries for Linux, Windows and WebGL. Compiles for Windows by mingw-w64 and for WebGL by emscripten.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/release/common.sh
out=$(mkdir -p "$1" && cd "$1" && pwd)
scripts/release/engines/runtimes.sh linux-shared windows-shared web-static

package=build/engines/unity/package
rm -rf build/engines/unity
mkdir -p $package/Runtime/Plugins/{Linux/x86_64,Windows/x86_64,WebGL} $package/Samples~/{Contacts,Response} $package/Documentation~
sed "s/\"version\": \"0.0.0\"/\"version\": \"$version\"/" runtime/unity/package.json >$package/package.json
cp runtime/unity/CHANGELOG.md $package/
cp runtime/unity/index.md $package/README.md
cp runtime/unity/index.md $package/Documentation~/
cp runtime/LICENSE $package/LICENSE.md
copy_notices "$package/Third Party Notices.md"
cp runtime/csharp/*.cs runtime/csharp/Spherechain.asmdef $package/Runtime/
cp samples/csharp/SelfCollision.cs $package/Samples~/Contacts/
cp runtime/unity/SelfCollisionResponse.cs $package/Samples~/Response/
strip -o $package/Runtime/Plugins/Linux/x86_64/libspherechain.so build/engines/linux-shared/lib/libspherechain.so
x86_64-w64-mingw32-strip -o $package/Runtime/Plugins/Windows/x86_64/spherechain.dll build/engines/windows-shared/bin/spherechain.dll
cp build/engines/web-static/lib/libspherechain.a $package/Runtime/Plugins/WebGL/
find $package -type f -exec chmod 644 {} +
scripts/release/engines/unity_metas.py $package
python3 scripts/release/archive.py $package "$out/com.spherechain.runtime-$version-unity.tgz"
echo "$out/com.spherechain.runtime-$version-unity.tgz"
