#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The zip for Windows under wine: what its DLL exports and needs, a stranger's project, and its samples, whose output is compared
# with Linux's: `scripts/release/try/windows.sh OUT`. It has not run on Windows itself.
set -euo pipefail
cd "$(dirname "$0")/../../.."
. scripts/release/windows_common.sh

zip=$(realpath "$1"/*windows*.zip)
try=$(mktemp -d)
trap 'rm -rf "$try"' EXIT
(cd "$try" && cmake -E tar xf "$zip")
sdk=$(ls -d "$try"/*)

# Exactly what the headers declare leaves the DLL, and it needs no DLL but those of every Windows.
dump=$(x86_64-w64-mingw32-objdump -p "$sdk/bin/spherechain.dll")
exported=$(sed -n '/Ordinal\/Name Pointer/,/^$/p' <<<"$dump" | awk '/\[/ && $NF !~ /Table$/ {print $NF}' | sort)
declared=$(grep -hoE 'SPHERECHAIN_API .*\bsc_[a-z_]+\(' "$sdk"/include/spherechain/*.h | grep -oE 'sc_[a-z_]+\($' | tr -d '(' | sort -u)
diff <(echo "$declared") <(echo "$exported") || { echo "windows: < is declared, > is exported" >&2; exit 1; }
imported=$(sed -n 's/^[\t ]*DLL Name: //p' <<<"$dump" | sort | tr '\n' ' ')
[[ $imported == "KERNEL32.dll msvcrt.dll " ]] || { echo "windows: the DLL needs $imported" >&2; exit 1; }
echo "spherechain.dll: $(wc -l <<<"$exported") functions, needs $imported"

cmake --build --preset release --target write_tiny_asset >/dev/null
build/release/bin/write_tiny_asset "$try/tiny.sphc"
try_stranger "$sdk" "$try/tiny.sphc" "$try/stranger"

# The zip's samples, built as its reader would; they print what Linux's print.
cmake -G Ninja --toolchain "$PWD/cmake/mingw.cmake" -S "$sdk/samples" -B $try/samples -D CMAKE_BUILD_TYPE=Release \
  -D SPHERECHAIN_WINDOWS_ROOT="$root" -D spherechain_DIR="$sdk/lib/cmake/spherechain" >/dev/null
cmake --build $try/samples >/dev/null
asset=build/release/samples/own_bones.sphc model=build/release/samples/human.glb
for sample in hello c_api load_and_refit crowd stop_at_contact duel; do
  if [[ ! -e $asset || ! -e $model || ! -x build/release/bin/$sample ]]; then
    echo "$sample is not compared: build/release has no sample of Linux, or its tests have baked no asset (ctest --preset release -R sample)"
    continue
  fi
  wine $try/samples/$sample.exe $asset $model | tr -d '\r' | sed 's/[0-9.]* us / us /' >$try/samples/$sample.txt
  "build/release/bin/$sample" $asset $model | sed 's/[0-9.]* us / us /' | diff - $try/samples/$sample.txt
  echo "$sample: $(wc -l <$try/samples/$sample.txt) lines as on Linux"
done
