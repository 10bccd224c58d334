#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tries the Unreal plugin of OUT: `scripts/release/try/unreal.sh OUT`. There is no Unreal here: the descriptor is compared with the keys
# that Unreal knows, the build rules run on a stub of UnrealBuildTool, and the C++ is compiled and run on stubs of Unreal's types,
# linked with the plugin's library, from a golden asset to a contact and a response.
set -euo pipefail
cd "$(dirname "$0")/../../.."
. scripts/release/common.sh
for command in mcs mono clang lld-link; do
  command -v $command >/dev/null || skip "$command is missing (Debian: mono-mcs, clang, lld)"
done
unpack "$1/spherechain-$version-unreal.zip"
plugin=$work/Spherechain
stubs=scripts/release/try/unreal
python3 $stubs/check_plugin.py "$plugin"

# The rules of each platform: all that they name is in the plugin.
mcs "$plugin"/Source/*/*.Build.cs $stubs/UnrealBuildTool.cs -out:"$work/Rules.exe"
for platform in Linux Win64; do
  mono "$work/Rules.exe" "$plugin" $platform >"$work/$platform"
  grep -c . "$work/$platform" | sed "s/.*/the rules for $platform name & things, and all are there/"
done

# A header of Unreal is the stubs. Headers that Unreal's tool generates are empty.
grep -rhoE '#include "[^"]+"' "$plugin/Source/Spherechain" "$plugin/Source/SpherechainEditor" | cut -d'"' -f2 | sort -u >"$work/included"
while read -r header; do
  [[ -z $(find "$plugin/Source/Spherechain" "$plugin/Source/SpherechainEditor" -name "$header") ]] || continue
  mkdir -p "$work/engine/$(dirname "$header")"
  [[ $header == *.generated.h ]] && : >"$work/engine/$header" || echo '#include "unreal_stubs.h"' >"$work/engine/$header"
done <"$work/included"
library=$plugin/Source/ThirdParty/spherechain
options=(-std=c++20 -O1 -Wall -Wno-unused -I"$work/engine" -I$stubs -I"$plugin/Source/Spherechain/Public" -I"$plugin/Source/Spherechain/Private"
  -isystem "$library/include")
sources=("$plugin"/Source/Spherechain/Private/*.cpp "$plugin"/Source/SpherechainEditor/*.cpp)
for source in "${sources[@]}"; do
  g++ "${options[@]}" -Werror -fsyntax-only -DPLATFORM_WINDOWS=1 -DSPHERECHAIN_SHARED=1 "$source"
done
g++ "${options[@]}" "${sources[@]}" $stubs/trial.cpp "$library/lib/Linux/libspherechain.a" -o "$work/trial"
"$work/trial" "$PWD/$doll"

# The library for Linux needs nothing that an old glibc lacks: Unreal brings its own.
nm -u "$library/lib/Linux/libspherechain.a" | awk '$1 == "U" && $2 !~ /^(sc_|_Z)/ {print $2}' | sort -u >"$work/needed"
diff "$work/needed" - <<'END'
_GLOBAL_OFFSET_TABLE_
__cpu_model
__popcountdi2
free
malloc
memcpy
memmove
memset
sqrt
sqrtf
strcmp
strlen
strncmp
vsnprintf
END
# The import library serves a linker of Microsoft's kind, with delay loading.
printf '%s\n' 'int sc_code_text(int);' 'int __delayLoadHelper2(void) { return 0; }' 'int entry(void) { return sc_code_text(0); }' >"$work/use.c"
clang --target=x86_64-pc-windows-msvc -ffreestanding -c "$work/use.c" -o "$work/use.obj"
lld-link /entry:entry /subsystem:console /nodefaultlib /delayload:spherechain.dll "/out:$work/use.exe" "$work/use.obj" "$library/lib/Win64/spherechain.lib"
echo "lld-link delays the loading of spherechain.dll"
