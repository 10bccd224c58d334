#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The zip for Windows under wine: what its DLL exports and needs, a stranger's project, and its samples, whose output is compared
# with Linux's: `scripts/release/try/windows.sh OUT`. It has not run on Windows itself.
set -euo pipefail
cd "$(dirname "$0")/../../.."
. scripts/release/windows_common.sh

model=/usr/share/assimp/models/Collada/human.zae
[[ -e $model ]] || skip "$model is missing (Debian: assimp-testmodels)"
unpack "$1/spherechain-sdk-$version-windows-x86_64.zip"
sdk=$(ls -d "$work"/*)

# Exactly what the headers declare leaves the DLL, and it needs no DLL but those of every Windows.
exported=$(exports_of "$sdk/bin/spherechain.dll")
declared=$(grep -hoE 'SPHERECHAIN_API .*\bsc_[a-z_]+\(' "$sdk"/include/spherechain/*.h | grep -oE 'sc_[a-z_]+\($' | tr -d '(' | sort -u)
diff <(echo "$declared") <(echo "$exported") || { echo "windows: < is declared, > is exported" >&2; exit 1; }
imported=$(objdump -p "$sdk/bin/spherechain.dll" | sed -n 's/^[\t ]*DLL Name: //p' | sort | tr '\n' ' ')
[[ $imported == "KERNEL32.dll msvcrt.dll " ]] || { echo "windows: the DLL needs $imported" >&2; exit 1; }
echo "spherechain.dll: $(wc -l <<<"$exported") functions, needs $imported"

write_tiny_asset "$work/tiny.sphc"
cmake --build --preset release --target spherechain pose_clip >/dev/null
try_stranger "$sdk" "$work/tiny.sphc" "$work/stranger"

# The zip's samples, built as its reader would. They print what they print on Linux with the archive of the SDK.
mkdir "$work/linux"
tar xf "$1/spherechain-sdk-$version-linux-x86_64.tar.gz" -C "$work/linux"
cmake -G Ninja --toolchain "$PWD/cmake/mingw.cmake" -S "$sdk/samples" -B "$work/samples" -D CMAKE_BUILD_TYPE=Release \
  -D SPHERECHAIN_WINDOWS_ROOT="$root" -D spherechain_DIR="$sdk/lib/cmake/spherechain" >/dev/null
cmake -G Ninja -S "$sdk/samples" -B "$work/linux/samples" -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH="$(ls -d "$work"/linux/*)" >/dev/null
cmake --build "$work/samples" >/dev/null
cmake --build "$work/linux/samples" >/dev/null
tool=build/release/bin/spherechain
$tool bake "$model" -o "$work/automatic.sphc" --preview "$work/preview.glb" >/dev/null 2>&1
build/release/bin/pose_clip "$work/preview.glb" samples/poses/animation_arms.json "$work/human.glb" >/dev/null
$tool bake "$work/human.glb" -o "$work/human.sphc" >/dev/null 2>&1
for sample in hello c_api load_and_refit crowd stop_at_contact duel; do
  wine "$work/samples/$sample.exe" "$work/human.sphc" "$work/human.glb" | tr -d '\r' | sed 's/[0-9.]* us / us /' >"$work/$sample.txt"
  "$work/linux/samples/$sample" "$work/human.sphc" "$work/human.glb" | sed 's/[0-9.]* us / us /' | diff - "$work/$sample.txt"
  echo "$sample: $(wc -l <"$work/$sample.txt") lines as on Linux"
done
