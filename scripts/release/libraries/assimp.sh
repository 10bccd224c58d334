#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Debian's assimp, compiled from Debian's source without writers and without IFC and glTF, which the tool does not read by it: less
# than half the size. `scripts/release/libraries/assimp.sh FOLDER` puts libassimp.so.5 there, once for each version. Where apt has no sources, or they
# do not compile, it prints why and leaves FOLDER empty; packages then hold Debian's own library.
set -euo pipefail
folder=$(realpath -m "$1")
cd "$(dirname "$0")/../../.."
. scripts/release/common.sh

version=$(dpkg-query -W -f '${source:Version}' libassimp-dev)
[[ ! -e $folder/$version ]] || exit 0
rm -rf "$folder"
mkdir -p "$folder"
needs dpkg-source dpkg-dev
[[ -e /usr/include/utf8.h ]] || needs "a header, utf8.h" libutfcpp-dev
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work"/{parts,lists/partial,cache/archives/partial}
# The machine's own sources, asked for sources.
for list in $(find /etc/apt/sources.list /etc/apt/sources.list.d -type f 2>/dev/null); do
  case $list in
    *.sources) sed 's/^Types:.*/Types: deb-src/' "$list" >"$work/parts/${list##*/}" ;;
    *.list) sed -n 's/^deb /deb-src /p' "$list" >"$work/parts/${list##*/}" ;;
  esac
done
apt=(apt-get -qq -o APT::Sandbox::User= -o Dir::Etc::sourcelist=- -o "Dir::Etc::sourceparts=$work/parts" -o "Dir::State::lists=$work/lists" -o "Dir::Cache=$work/cache")
"${apt[@]}" update >/dev/null 2>&1 || true
if ! (cd "$work" && "${apt[@]}" source "assimp=$version") >"$work/log" 2>&1; then
  echo "note: the packages hold the whole assimp: apt has no source of assimp $version: $(tail -1 "$work/log")"
  exit 0
fi
source=$(echo "$work"/assimp-*/)
if ! {
  cmake -G Ninja -S "$source" -B "$work/build" -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_FLAGS_RELEASE="-O2 -DNDEBUG -ffunction-sections -fdata-sections -ffile-prefix-map=$work=." \
    -D ASSIMP_NO_EXPORT=ON -D ASSIMP_BUILD_IFC_IMPORTER=OFF -D ASSIMP_BUILD_GLTF_IMPORTER=OFF -D ASSIMP_BUILD_ASSIMP_TOOLS=OFF -D ASSIMP_BUILD_TESTS=OFF \
    -D ASSIMP_BUILD_ZLIB=OFF -D ASSIMP_WARNINGS_AS_ERRORS=OFF -D ASSIMP_INSTALL=OFF \
    -D CMAKE_SHARED_LINKER_FLAGS="-Wl,--version-script=$source/debian/libassimp.ver -Wl,--gc-sections -Wl,--as-needed" && cmake --build "$work/build"
} >"$work/log" 2>&1; then
  echo "note: the packages hold the whole assimp: assimp $version does not compile here: $(grep -m 1 'error' "$work/log")"
  exit 0
fi
cp -L "$work/build/bin/libassimp.so.5" "$folder"
touch "$folder/$version"
