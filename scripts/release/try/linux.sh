#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs Debian's packages in a bare Debian 12 and uses them as a stranger does: the tool bakes and views a character; a project
# finds the library by pkg-config and by CMake. Then the same of the archives, with no package but a compiler:
# `scripts/release/try/linux.sh OUT`. As root, with Debian's servers. Two minutes the first time.
set -euo pipefail
cd "$(dirname "$0")/../../.."
. scripts/release/common.sh

[[ $(id -u) -eq 0 ]] || skip "a bare Debian needs root, for chroot"
model=/usr/share/assimp/models/Collada/human.zae
[[ -e $model ]] || skip "$model is missing (Debian: assimp-testmodels)"
try=$(mktemp -d)
trap 'rm -r "$try"' EXIT
cp "$1"/*.deb "$1"/*linux*.tar.gz "$try/"
cp -r tests/package/stranger "$try/"
write_tiny_asset "$try/tiny.sphc"
cp "$model" "$try/"
cat >"$try/run.sh" <<END
tiny_contacts="$tiny_contacts"
END
cat >>"$try/run.sh" <<'END'
set -euo pipefail
check() { "$1" tiny.sphc | diff - <(echo "$tiny_contacts") && echo "$1: as it should be"; }
bake() {
  "$1" bake human.zae -o human.sphc | tail -1
  "$1" view human.sphc --source human.zae -o view.html
}
apt-get update -qq
apt-get install -y -qq --no-install-recommends ./libspherechain_*.deb ./libspherechain-dev_*.deb ./spherechain_*.deb >/dev/null 2>log || { cat log; exit 1; }
cat /etc/debian_version
spherechain --version
bake spherechain
apt-get install -y -qq --no-install-recommends g++ libc6-dev cmake ninja-build pkg-config >/dev/null 2>log || { cat log; exit 1; }
cc -std=c99 stranger/stranger.c $(pkg-config --cflags --libs spherechain) -o by_pkg_config
check ./by_pkg_config
cmake -G Ninja -S stranger -B by_cmake >/dev/null && cmake --build by_cmake >/dev/null
check by_cmake/stranger_c
check by_cmake/stranger_cpp
apt-get purge -y -qq 'libspherechain*' spherechain libassimp5 libtinygltf2d libpugixml1v5 >/dev/null 2>&1
for archive in *.tar.gz; do tar xf "$archive" --keep-old-files; done  # neither has a file of the other
rm human.sphc view.html
bake spherechain-*-linux-x86_64/bin/spherechain
cmake -G Ninja -S stranger -B by_archive -D CMAKE_PREFIX_PATH="$(ls -d "$PWD"/spherechain-*-linux-x86_64/)" >/dev/null && cmake --build by_archive >/dev/null
check by_archive/stranger_cpp
END
scripts/in_bare_debian.sh "$try" bash run.sh
