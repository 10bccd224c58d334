#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The zip for Windows under wine: what its DLL exports and needs, a stranger's project, and its samples, whose output is compared
# with Linux's: `scripts/release/try/windows.sh OUT`. It has not run on Windows itself.
set -euo pipefail
cd "$(dirname "$0")/../../.."
. scripts/release/windows_common.sh

model=/usr/share/assimp/models/Collada/human.zae
[[ -e $model ]] || skip "$model is missing (Debian: assimp-testmodels)"
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

cmake --build --preset release --target spherechain write_tiny_asset pose_clip >/dev/null
build/release/bin/write_tiny_asset "$try/tiny.sphc"
try_stranger "$sdk" "$try/tiny.sphc" "$try/stranger"

# The zip's samples, built as its reader would. They print what they print on Linux with the archive of the SDK.
mkdir "$try/linux"
tar xf "$1/spherechain-sdk-$version-linux-x86_64.tar.gz" -C "$try/linux"
cmake -G Ninja --toolchain "$PWD/cmake/mingw.cmake" -S "$sdk/samples" -B "$try/samples" -D CMAKE_BUILD_TYPE=Release \
  -D SPHERECHAIN_WINDOWS_ROOT="$root" -D spherechain_DIR="$sdk/lib/cmake/spherechain" >/dev/null
cmake -G Ninja -S "$sdk/samples" -B "$try/linux/samples" -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH="$(ls -d "$try"/linux/*)" >/dev/null
cmake --build "$try/samples" >/dev/null
cmake --build "$try/linux/samples" >/dev/null
tool=build/release/bin/spherechain
$tool bake "$model" -o "$try/automatic.sphc" --preview "$try/preview.glb" >/dev/null 2>&1
build/release/bin/pose_clip "$try/preview.glb" samples/poses/animation_arms.json "$try/human.glb" >/dev/null
$tool bake "$try/human.glb" -o "$try/human.sphc" >/dev/null 2>&1
for sample in hello c_api load_and_refit crowd stop_at_contact duel; do
  wine "$try/samples/$sample.exe" "$try/human.sphc" "$try/human.glb" | tr -d '\r' | sed 's/[0-9.]* us / us /' >"$try/$sample.txt"
  "$try/linux/samples/$sample" "$try/human.sphc" "$try/human.glb" | sed 's/[0-9.]* us / us /' | diff - "$try/$sample.txt"
  echo "$sample: $(wc -l <"$try/$sample.txt") lines as on Linux"
done
