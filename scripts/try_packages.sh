#!/usr/bin/env bash
# Installs the packages of scripts/package.sh in a bare Debian 12 and uses them as a stranger does: the tool bakes and views a
# character; a project finds the library by pkg-config and by CMake, then the unpacked archive. `scripts/try_packages.sh`. As
# root, with Debian's servers. Two minutes the first time.
set -euo pipefail
cd "$(dirname "$0")/.."

[[ -e build/packages ]] || { echo "try_packages: no build/packages: run scripts/package.sh first" >&2; exit 1; }
try=$(mktemp -d)
trap 'rm -r "$try"' EXIT
cp build/packages/*.deb build/packages/*.tar.gz "$try/"
cp -r tests/package/stranger "$try/"
cmake --build --preset release --target write_tiny_asset >/dev/null
build/release/bin/write_tiny_asset "$try/tiny.sphc"
cp /usr/share/assimp/models/Collada/human.zae "$try/"
cat >"$try/run.sh" <<'EOF'
set -euo pipefail
check() { "$1" tiny.sphc | diff - <(echo "60 spheres, 175 pairs, 4 pairs of body parts") && echo "$1: as it should be"; }
apt-get update -qq
apt-get install -y -qq --no-install-recommends ./libspherechain_*.deb ./libspherechain-dev_*.deb ./spherechain_*.deb >/dev/null 2>log || { cat log; exit 1; }
cat /etc/debian_version
spherechain --version
spherechain bake human.zae -o human.sphc | tail -1
spherechain view human.sphc --source human.zae -o view.html
apt-get install -y -qq --no-install-recommends g++ libc6-dev cmake ninja-build pkg-config >/dev/null 2>log || { cat log; exit 1; }
cc -std=c99 stranger/stranger.c $(pkg-config --cflags --libs spherechain) -o by_pkg_config
check ./by_pkg_config
cmake -G Ninja -S stranger -B by_cmake >/dev/null && cmake --build by_cmake >/dev/null
check by_cmake/stranger_c
check by_cmake/stranger_cpp
apt-get purge -y -qq 'libspherechain*' spherechain >/dev/null 2>&1
tar xf spherechain-sdk-*.tar.gz
cmake -G Ninja -S stranger -B by_archive -D CMAKE_PREFIX_PATH="$(ls -d "$PWD"/spherechain-*-Linux-*/)" >/dev/null && cmake --build by_archive >/dev/null
check by_archive/stranger_cpp
EOF
scripts/in_bare_debian.sh "$try" bash run.sh
