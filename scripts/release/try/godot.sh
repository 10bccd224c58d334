#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tries the Godot addon of OUT: `scripts/release/try/godot.sh OUT`. A program with the functions of Godot's extension interface
# loads its libraries as Godot does, the one for Windows with wine, and goes from a golden asset to a contact and a response.
set -euo pipefail
cd "$(dirname "$0")/../../.."
. scripts/release/common.sh
unpack "$1/spherechain-$version-godot.zip"
addon=$work/addons/spherechain

# Each library that the .gdextension names is there, and has the entry.
entry=$(sed -n 's/^entry_symbol = "\(.*\)"$/\1/p' "$addon/spherechain.gdextension")
libraries=$(sed -n 's/^[a-z]*\.x86_64\.single = "\(.*\)"$/\1/p' "$addon/spherechain.gdextension")
[[ $(wc -l <<<"$libraries") -eq 2 ]]
for library in $libraries; do grep -q "$entry" "$addon/$library"; done
exported=$(nm -D --defined-only "$addon/bin/libspherechain_godot.linux.x86_64.so" | awk '{print $3}')
[[ $exported == "$entry" ]] || { echo "the library for Linux exports $exported" >&2; exit 1; }

sources=(scripts/release/try/godot/*.cpp)
options=(-std=c++20 -O1 -I.)
scripts/release/engines/runtimes.sh linux-static
g++ "${options[@]}" -Ibuild/engines/linux-static/include "${sources[@]}" build/engines/linux-static/lib/libspherechain.a -ldl -o "$work/trial"
"$work/trial" "$addon/bin/libspherechain_godot.linux.x86_64.so" "$doll" "$work/copy.sphc"
if command -v x86_64-w64-mingw32-g++-posix >/dev/null && command -v wine >/dev/null; then
  scripts/release/engines/runtimes.sh windows-static
  x86_64-w64-mingw32-g++-posix "${options[@]}" -static -Ibuild/engines/windows-static/include "${sources[@]}" \
    build/engines/windows-static/lib/libspherechain.a -o "$work/trial.exe"
  WINEPREFIX=$PWD/build/wine WINEDEBUG=-all wine "$work/trial.exe" "$addon/bin/libspherechain_godot.windows.x86_64.dll" "$doll" "$work/copy.sphc"
else
  echo "the library for Windows is not tried: wine or mingw-w64 is missing"
fi
