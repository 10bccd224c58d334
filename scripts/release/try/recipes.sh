#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tries the recipes of OUT: `scripts/release/try/recipes.sh OUT`. There is no vcpkg and no Conan here: their steps run on stubs, with
# the files that CMake installs, and the programs of a stranger find the library there.
set -euo pipefail
cd "$(dirname "$0")/../../.."
. scripts/release/common.sh
unpack "$1/spherechain-$version-recipes.zip"
recipes=$work/recipes
scripts/release/engines/runtimes.sh linux-static
build=$PWD/build/engines/build-linux-static

cmake -D PORT_FOLDER="$recipes/vcpkg/ports/spherechain" -D BUILD="$build" -D PACKAGES="$work/vcpkg" -D ROOT="$PWD" -P scripts/release/try/recipes/vcpkg.cmake
[[ -z $(find "$work/vcpkg" -type d -empty) ]] || { echo "recipes: the port leaves empty folders" >&2; exit 1; }
cmake -G Ninja -S tests/package/stranger -B "$work/stranger" -D CMAKE_PREFIX_PATH="$work/vcpkg" -D CMAKE_FIND_USE_PACKAGE_REGISTRY=OFF >/dev/null
cmake --build "$work/stranger" >/dev/null
write_tiny_asset "$work/tiny.sphc"
"$work/stranger/stranger_c" "$work/tiny.sphc" | diff - <(echo "$tiny_contacts")
echo "vcpkg: $tiny_contacts"

recipe=$recipes/conan/recipes/spherechain/all
python3 scripts/release/try/recipes/conan_steps.py "$recipe" "$build" "$PWD/build/engines/linux-static"
cmake -G Ninja -S "$recipe/test_package" -B "$work/test_package" -D CMAKE_PREFIX_PATH="$PWD/build/engines/linux-static" -D CMAKE_FIND_USE_PACKAGE_REGISTRY=OFF >/dev/null
cmake --build "$work/test_package" >/dev/null
"$work/test_package/test_package"
