#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Packages for Linux (x86-64): `scripts/release/linux.sh OUT`. For Debian libspherechain, libspherechain-dev and spherechain; for
# others archives of the SDK with the static library, and of the tool with the libraries that it needs. Uses build/release, which
# it completes; the shared library is built in build/package-shared.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/release/common.sh
needs patchelf patchelf

build_tool
cmake --preset release -B build/package-shared -D CMAKE_INSTALL_PREFIX=/usr -D BUILD_SHARED_LIBS=ON -D SPHERECHAIN_BAKER=OFF \
  -D SPHERECHAIN_TESTS=OFF -D SPHERECHAIN_CUDA=OFF >/dev/null
cmake --build build/package-shared >/dev/null
stage=$PWD/build/release-stage/linux name=spherechain-$version-linux-x86_64
rm -rf "$stage"
for build in package-shared release; do
  cpack --config build/$build/CPackConfig.cmake -G DEB -B "$stage/debian" >/dev/null
done
# CPack's archives have the time of the build, and files in the order of the disk.
for package in "$stage"/debian/*.deb; do
  dpkg-deb --raw-extract "$package" "$stage/raw"
  dpkg-deb --root-owner-group --build "$stage/raw" "$1/$(basename "$package")" >/dev/null
  rm -r "$stage/raw"
  echo "$1/$(basename "$package")"
done

# Both archives unpack into one folder, so that their licences lie in two.
cmake --install build/release --component sdk --prefix "$stage/sdk/$name" --strip >/dev/null
mv "$stage/sdk/$name/share/doc/spherechain" "$stage/sdk/$name/share/doc/libspherechain"
copy_notices "$stage/sdk/$name/share/doc/libspherechain/copyright"
python3 scripts/release/archive.py "$stage/sdk/$name" "$1/spherechain-sdk-$version-linux-x86_64.tar.gz"
python3 scripts/release/tool_bundle.py "$stage/tool/$name"
python3 scripts/release/archive.py "$stage/tool/$name" "$1/$name.tar.gz"
ls "$1/spherechain-sdk-$version-linux-x86_64.tar.gz" "$1/$name.tar.gz"
