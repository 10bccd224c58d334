#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tries the Unity package of OUT: `scripts/release/try/unity.sh OUT`. Checks its manifest and its .meta files, compiles its C# by
# mono's compiler for each platform, and runs both samples on stubs of Unity's classes with the library for Linux. Links the
# library for WebGL into a program that Node runs.
set -euo pipefail
cd "$(dirname "$0")/../../.."
. scripts/release/common.sh
for command in mcs mono python3; do
  command -v $command >/dev/null || skip "$command is missing (Debian: mono-mcs)"
done
doll=$(find tests/golden -name doll.sphc | sort | head -1)
tarball=$(ls "$1"/*unity*.tgz)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tar xzf "$tarball" -C "$work"
package=$work/package
python3 scripts/release/try/unity/check_package.py "$package"

for platform in "" -define:UNITY_WEBGL; do
  mcs -unsafe -langversion:7.2 -target:library $platform "$package"/Runtime/*.cs -out:"$work/Spherechain.dll"
done
mcs -unsafe -langversion:7.2 -target:library "$package"/Runtime/*.cs -out:"$work/Spherechain.dll"
mcs -langversion:7.2 -r:"$work/Spherechain.dll" tests/csharp/UnityStubs.cs scripts/release/try/unity/Trial.cs \
  "$package"/Samples~/*/*.cs -out:"$work/Trial.exe"
LD_LIBRARY_PATH=$package/Runtime/Plugins/Linux/x86_64 mono "$work/Trial.exe" "$doll"

# Each function that C# declares is in the other two libraries.
grep -oE 'extern [^(]*sc_[a-z_]+\(' "$package/Runtime/Spherechain.Native.cs" | grep -oE 'sc_[a-z_]+' | sort -u >"$work/declared"
python3 scripts/release/engines/exports.py "$package/Runtime/Plugins/Windows/x86_64/spherechain.dll" | sort -u >"$work/windows"
diff "$work/declared" "$work/windows"
echo "spherechain.dll exports $(wc -l <"$work/declared") functions"
if command -v emcc >/dev/null && command -v node >/dev/null; then
  web=$package/Runtime/Plugins/WebGL/libspherechain.a
  # A program that refers to all of them, and one in C that finds contacts, as it does on Linux. The doll has none at rest.
  asset=$PWD/$doll
  if [[ -x build/release/bin/write_tiny_asset ]]; then
    asset=$work/tiny.sphc
    build/release/bin/write_tiny_asset "$asset"
  fi
  { sed 's/.*/extern void &(void);/' "$work/declared"; echo 'int main(void) { void (*volatile all[])(void) = {'
    sed 's/$/,/' "$work/declared"; echo '}; return all[0] == 0; }'; } >"$work/all.c"
  emcc "$work/all.c" "$web" -o "$work/all.js"
  node --no-experimental-fetch "$work/all.js"
  headers=(-Iruntime/include -Ibuild/engines/build-web-static/runtime/include)
  emcc tests/package/stranger/stranger.c "${headers[@]}" "$web" -sNODERAWFS=1 -sALLOW_MEMORY_GROWTH=1 -o "$work/web.js"
  cc -std=c99 tests/package/stranger/stranger.c "${headers[@]}" "$package/Runtime/Plugins/Linux/x86_64/libspherechain.so" -o "$work/linux"
  LD_PRELOAD=$package/Runtime/Plugins/Linux/x86_64/libspherechain.so "$work/linux" "$asset" >"$work/expected"
  node --no-experimental-fetch "$work/web.js" "$asset" | diff "$work/expected" -
  echo "libspherechain.a for WebGL: $(cat "$work/expected")"
else
  echo "the library for WebGL is not linked: emcc or node is missing"
fi
