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
unpack "$1/com.spherechain.runtime-$version-unity.tgz"
package=$work/package
python3 scripts/release/try/unity/check_package.py "$package"

for platform in -define:UNITY_WEBGL ""; do  # the samples run with the second
  mcs -unsafe -langversion:7.2 -target:library $platform "$package"/Runtime/*.cs -out:"$work/Spherechain.dll"
done
mcs -langversion:7.2 -r:"$work/Spherechain.dll" tests/csharp/UnityStubs.cs scripts/release/try/unity/Trial.cs \
  "$package"/Samples~/*/*.cs -out:"$work/Trial.exe"
LD_LIBRARY_PATH=$package/Runtime/Plugins/Linux/x86_64 mono "$work/Trial.exe" "$doll"

# Each function that C# declares is in the other two libraries.
grep -oE 'extern [^(]*sc_[a-z_]+\(' "$package/Runtime/Spherechain.Native.cs" | grep -oE 'sc_[a-z_]+' | sort -u >"$work/declared"
exports_of "$package/Runtime/Plugins/Windows/x86_64/spherechain.dll" | diff "$work/declared" -
echo "spherechain.dll exports $(wc -l <"$work/declared") functions"
if command -v emcc >/dev/null && command -v node >/dev/null; then
  web=$package/Runtime/Plugins/WebGL/libspherechain.a
  # A program that refers to all of them, and one in C that finds contacts.
  scripts/release/engines/runtimes.sh web-static
  write_tiny_asset "$work/tiny.sphc"
  { sed 's/.*/extern void &(void);/' "$work/declared"; echo 'int main(void) { void (*volatile all[])(void) = {'
    sed 's/$/,/' "$work/declared"; echo '}; return all[0] == 0; }'; } >"$work/all.c"
  emcc "$work/all.c" "$web" -o "$work/all.js"
  node --no-experimental-fetch "$work/all.js"
  headers=(-Iruntime/include -Ibuild/engines/build-web-static/runtime/include)
  emcc tests/package/stranger/stranger.c "${headers[@]}" "$web" -sNODERAWFS=1 -sALLOW_MEMORY_GROWTH=1 -o "$work/web.js"
  node --no-experimental-fetch "$work/web.js" "$work/tiny.sphc" | diff - <(echo "$tiny_contacts")
  echo "libspherechain.a for WebGL: $tiny_contacts"
else
  echo "the library for WebGL is not linked: emcc or node is missing"
fi
